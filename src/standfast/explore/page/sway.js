/** How the person sways under noise, in numbers and as an ellipse: what is shown of it; pure. */
import { measured, measuredUnit, shortNumber } from "./content.js";
import { JOINTS } from "./facts.js";

const DEGREES = 180 / Math.PI;
/** Names of what is known of sway, and in words. */
const SHOWN_SWAY = [
  ["ankle_sway", "Ankle rotation, SD"],
  ["knee_sway", "Knee rotation, SD"],
  ["hip_sway", "Hip rotation, SD"],
  ["com_sway", "Centre of mass, SD"],
  ["cop_sway", "Centre of pressure, SD"],
  ["cop_velocity", "Its velocity, SD"],
  ["cop_frequency", "Its mean frequency"],
];
const AS_IT_IS = { unit: "Hz", factor: 1 };
/** 95 % of a normal pair lie within so many SDs: the root of −2 ln 0.05; of one normal number, 1.96. */
export const WITHIN = Math.sqrt(-2 * Math.log(0.05));
export const WITHIN_ONE = 1.959964;

const NOTHING_DAMPS =
  "Nothing damps the person, and noise moves it ever more: set a damping or a gain.";

/**
 * What is shown of the sway of a person with noise: a sentence, or rows and a picture.
 * @param {object} nerves what nerves do (facts.js)
 * @param {{stands: boolean|null, sway: object|null}|null} answer what the program said, if it did
 * @param {boolean} served whether there is a program to ask
 * @param {boolean} waiting whether it has been asked and has not answered
 * @param {object} seen in which unit each of them is read, by name
 * @returns {{sentence: string, rows: string[][], picture: object|null}}
 */
export function shownSway(nerves, answer, served, waiting, seen) {
  const only = (sentence) => ({ sentence, rows: [], picture: null });
  if (!nerves.damped && !nerves.gained) return only(NOTHING_DAMPS);
  if (!served) return only("Sway needs the program (standfast explore).");
  const sway = answer?.sway;
  if (!sway) return only(waiting ? "computing…" : "The program found no sway.");
  if (sway.cop_sway === Number.POSITIVE_INFINITY) {
    return only(answer.stands ? NOTHING_DAMPS : "The person falls, and so has no sway.");
  }
  const free = (name) => !JOINTS.includes(name) || nerves.free.includes(name);
  const rows = SHOWN_SWAY.filter(([name]) => free(name.replace(/_sway$/, ""))).map(
    ([name, words]) => [words, known(sway[name], seen[name] ?? AS_IT_IS)],
  );
  return { sentence: "", rows, picture: pictureOfSway(sway.covariance, nerves.free) };
}

function known(value, { unit, factor }) {
  return Number.isNaN(value) ? "open within rounding" : measuredUnit(factor * value, unit, 3);
}

/**
 * The pair of joints that is drawn, or the one that turns, in degrees; null where it is open.
 * Of three the ankle and the hip are.
 */
function pictureOfSway(covariance, free) {
  const joints = free.length === 3 ? ["ankle", "hip"] : free;
  const at = joints.map((joint) => JOINTS.indexOf(joint));
  const deviations = at.map((i) => DEGREES * Math.sqrt(covariance[i][i]));
  if (deviations.some((size) => !(size > 0))) return null;
  const [i, j] = at;
  const together =
    at.length === 1 ? 0 : (DEGREES ** 2 * covariance[i][j]) / (deviations[0] * deviations[1]);
  return { joints, deviations, together };
}

/** The picture in words. */
export function swayWords({ joints, deviations, together }) {
  const within = joints.length === 1 ? WITHIN_ONE : WITHIN;
  const sides = joints.map(
    (joint, i) => `${joint} rotation ±${measured(within * deviations[i], 3)}°`,
  );
  if (joints.length === 1) return `95 % of the time: ${sides[0]}`;
  return `95 % ellipse of sway: ${sides.join(", ")}; correlation ${shortNumber(together, 2)}`;
}

/** Points around the 95 % ellipse of a picture, degrees. */
export function ellipseOf({ deviations: [across, up], together }, count = 72) {
  const rest = Math.sqrt(Math.max(0, 1 - together * together));
  return Array.from({ length: count }, (_, k) => {
    const angle = (2 * Math.PI * k) / count;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    return [WITHIN * across * cos, WITHIN * up * (together * cos + rest * sin)];
  });
}
