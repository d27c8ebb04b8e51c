/** What the reader has chosen, and how it stands in the address. */
import { axesOf, encoded, finiteStops, shortNumber, valueWords } from "./content.js";
import { axisOf, windowOf } from "./frame.js";

/** The state that the page opens with. */
export function startState(content) {
  const values = Object.fromEntries(content.parameters.map((row) => [row.name, row.start]));
  return { values, ...content.start, window: null };
}

/** The part of the address behind #: only what differs from the start. */
export function hashOf(content, state) {
  const parts = [];
  for (const row of content.parameters) {
    const value = state.values[row.name];
    if (!Object.is(value, row.start)) parts.push([row.name, encoded(value)]);
  }
  for (const key of ["x", "y", "quantity"]) {
    if (state[key] !== content.start[key]) parts.push([key, state[key]]);
  }
  if (state.window) {
    parts.push(["window", state.window.map((v) => Number(v.toPrecision(8))).join(",")]);
  }
  return parts
    .map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll("%2C", ",")}`)
    .join("&");
}

/**
 * The state that an address describes; what it says wrongly is left out and named in `ignored`, and
 * what an atlas has at another value in `moved`.
 * @returns {{state: object, ignored: string[], moved: string[]}}
 */
export function stateOf(content, hash) {
  const state = startState(content);
  const ignored = [];
  const moved = [];
  const axes = new Set(axesOf(content).map((row) => row.name));
  for (const part of hash.replace(/^#/, "").split("&").filter(Boolean)) {
    const [name, text] = splitAt(part);
    const row = Object.hasOwn(content.parameter, name) ? content.parameter[name] : null;
    const value = row ? checkedValue(row, text) : undefined;
    if (value !== undefined) {
      state.values[name] = value;
      if (Number.isFinite(value) && value !== Number(text)) {
        moved.push(`${row.words} ${text} is shown at ${valueWords(row, value)}`);
      }
    } else if ((name === "x" || name === "y") && axes.has(text)) state[name] = text;
    else if (name === "quantity" && Object.hasOwn(content.quantity, text)) state.quantity = text;
    else if (name === "window" && writtenWindow(text)) state.window = writtenWindow(text);
    else ignored.push(part);
  }
  if (state.x === state.y) Object.assign(state, { x: content.start.x, y: content.start.y });
  if (state.window) {
    state.window = windowOf(state, axisOf(content, state.x), axisOf(content, state.y));
  }
  return { state, ignored, moved };
}

function splitAt(part) {
  const at = part.indexOf("=");
  try {
    return [part.slice(0, at), decodeURIComponent(part.slice(at + 1))];
  } catch {
    return ["", ""];
  }
}

function writtenWindow(text) {
  const numbers = text.split(",").map(Number);
  const right = numbers.length === 4 && numbers.every(Number.isFinite);
  return right && numbers[0] < numbers[1] && numbers[2] < numbers[3] ? numbers : null;
}

/**
 * The value of a parameter that a text says, or undefined if the parameter cannot have it.
 * A parameter with stops takes the nearest of them.
 */
export function checkedValue(row, text) {
  if (row.kind === "fixed") return undefined;
  if (!row.numeric) {
    const words = row.kind === "stops" ? row.stops : row.choices;
    return words.includes(text) ? text : undefined;
  }
  const rigid = /^(inf|rigid|∞)$/.test(text.trim());
  if (rigid) {
    const may = row.kind === "stops" ? row.stops.includes(Number.POSITIVE_INFINITY) : row.or_rigid;
    return may ? Number.POSITIVE_INFINITY : undefined;
  }
  const value = text.trim() === "" ? Number.NaN : Number(text.trim().replace("−", "-"));
  if (!Number.isFinite(value)) return undefined;
  if (row.kind === "stops") return nearestStop(row.stops, value);
  return value >= row.lowest && value <= row.highest ? value : undefined;
}

/** The range of a parameter in words, for whoever typed what it cannot have. */
export function allowedWords(row) {
  const unit = row.unit === "1" ? "" : ` ${row.unit}`;
  const stops = finiteStops(row);
  const [low, high] = stops.length ? [stops[0], stops.at(-1)] : [row.lowest, row.highest];
  const rigid = row.stops.includes(Number.POSITIVE_INFINITY) ? ", or rigid" : "";
  return `${shortNumber(low)} to ${shortNumber(high)}${unit}${rigid}`;
}

/** The stop that lies nearest to a value. */
export function nearestStop(stops, value) {
  if (value === Number.POSITIVE_INFINITY && stops.includes(value)) return value;
  const away = (stop) => (Number.isFinite(stop) ? Math.abs(stop - value) : Number.MAX_VALUE);
  return stops.reduce((best, stop) => (away(stop) < away(best) ? stop : best));
}

/** Where the formulas take a parameter from; a measured segment is one of the reference person. */
export function slotOf(slots, name) {
  return slots[name] ?? slots[`reference_${name}`];
}

/** Write the person of a state into the vector that the formulas are given. */
export function fillPerson(content, slots, values, person) {
  person.fill(0);
  const own = content.people[values.body_model] ?? Object.values(content.people)[0];
  for (const [name, value] of Object.entries(own)) person[slots[`reference_${name}`]] = value;
  for (const [name, value] of Object.entries(values)) {
    const slot = slotOf(slots, name);
    if (slot !== undefined && typeof value === "number") person[slot] = value;
  }
  if (!("height" in values)) {
    // measured segments: a reference of height 1 and mass 1, taken as it is
    for (const name of ["height", "mass"]) {
      person[slots[name]] = 1;
      person[slots[`reference_${name}`]] = 1;
    }
  }
  person[slots.by_bmi] = "bmi" in values && !("mass" in values) ? 1 : 0;
  if (!("gravity" in values)) person[slots.gravity] = content.constants.gravity;
  return person;
}
