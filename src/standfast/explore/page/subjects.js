/** Subjects on the map and in the sliders: what of them the page shows otherwise, or not; pure. */
import { encoded, valueWords, withUnit } from "./content.js";
import { checkedValue } from "./state.js";

const SAME = 1e-6; // relative; nearer values are the same
const NAMED = 4; // subjects in a sentence
const SIZES = ["mass", "bmi"]; // one follows from the other by the height

/**
 * The values of a subject as the page can have them, and in words where these are others.
 * @returns {{values: object, words: string[]}}
 */
export function takenFrom(content, subject) {
  const values = {};
  const words = [];
  for (const [name, own] of Object.entries(subject.values)) {
    const row = content.parameter[name];
    if (!row) {
      if (!isKnown(content, name, own)) words.push(`${name} ${own} is not part of this page`);
      continue;
    }
    const said = `${row.words} ${valueWords(row, own)}`;
    const value = row.kind === "fixed" ? row.start : checkedValue(row, String(encoded(own)));
    if (value === undefined) {
      words.push(`${said} is not among the values of the atlas`);
      continue;
    }
    if (row.kind !== "fixed") values[name] = value;
    if (!areSame(value, own)) words.push(`${said} is shown at ${valueWords(row, value)}`);
  }
  return { values, words };
}

/** A parameter that the page does not have changes nothing if it is 0, or follows from others. */
function isKnown(content, name, own) {
  const other = SIZES[1 - SIZES.indexOf(name)];
  return own === 0 || (SIZES.includes(name) && other in content.parameter);
}

function areSame(one, other) {
  if (Object.is(one, other)) return true;
  if (!Number.isFinite(one) || !Number.isFinite(other)) return false;
  return Math.abs(one - other) <= SAME * Math.max(Math.abs(one), Math.abs(other));
}

/** How a sentence calls a subject. */
export function calledOf(subjects, i) {
  return subjects[i].label || `subject ${i + 1}`;
}

/** What is shown otherwise of the subject that the reader has chosen; "" if nothing is. */
export function takenWords(content, i) {
  const { words } = takenFrom(content, content.subjects[i]);
  return words.length ? `${calledOf(content.subjects, i)}: ${words.join("; ")}.` : "";
}

/**
 * Who is not seen on the map, or is marked on a map of other values than their own, in sentences.
 * @param {object} view axes x and y, and the window that is seen
 */
export function marksWords(content, { x, y, window }, values) {
  const axes = [
    [x.row, window[0], window[1]],
    [y.row, window[2], window[3]],
  ];
  const sentences = [];
  const person = absence(axes, values);
  if (person) sentences.push(`The person is not on the map: ${person}.`);
  const { subjects } = content;
  const absent = [];
  const otherwise = [];
  subjects.forEach((subject, i) => {
    const why = absence(axes, subject.values);
    const others = why ? [] : othersOf(content, axes, subject.values, values);
    if (why) absent.push(`${calledOf(subjects, i)} (${why})`);
    else if (others.length) otherwise.push(`${calledOf(subjects, i)} (${others.join(", ")})`);
  });
  if (absent.length) sentences.push(`Not on the map: ${listed(absent)}.`);
  if (otherwise.length) {
    sentences.push(`Marked here, though of other values than the sliders': ${listed(otherwise)}.`);
  }
  return sentences.join(" ");
}

/** Why a person cannot be seen on the map; "" if it can. */
function absence(axes, values) {
  const words = [];
  for (const [row, low, high] of axes) {
    const value = values[row.name];
    if (value === undefined) words.push(`${row.words} not given`);
    else if (value === Number.POSITIVE_INFINITY) words.push(`${row.words} rigid`);
    else if (value < low || value > high) {
      words.push(`${row.words} ${withUnit(value, row.unit)}, outside`);
    }
  }
  return words.join(", ");
}

/** What a subject has otherwise than the map, in words. */
function othersOf(content, axes, own, values) {
  return content.parameters
    .filter((row) => row.name in own && !axes.some(([axis]) => axis === row))
    .filter((row) => !areSame(own[row.name], values[row.name]))
    .map((row) => `${row.words} ${valueWords(row, own[row.name])}`);
}

function listed(words) {
  const more = words.length - NAMED;
  return words.slice(0, NAMED).join(", ") + (more > 0 ? `, and ${more} more` : "");
}
