/** The frame of the map: its axes, evenly or by factors, and the window that is seen; pure. */
import { finiteStops, isLogarithmic } from "./content.js";

/** One axis of the map: its ends, and how a value becomes a place on the screen's scale. */
export function axisOf(content, name) {
  const row = content.parameter[name];
  const stops = row.kind === "stops" ? finiteStops(row) : null;
  const [low, high] = stops ? [stops[0], stops.at(-1)] : [row.from, row.to];
  const logarithmic = stops !== null && isLogarithmic(stops);
  const place = logarithmic ? Math.log10 : (value) => value;
  const value = logarithmic ? (at) => 10 ** at : (at) => at;
  const beyond = stops ? [low, high] : [row.lowest, row.highest];
  return { row, stops, low, high, beyond, logarithmic, place, value };
}

// Of an axis, or of its values: what is narrower cannot be told apart on it.
const NARROWEST = 1e-6;

/** The narrowest that two places of an axis may be apart. */
function narrowestOf(axis, from, to) {
  const whole = axis.place(axis.high) - axis.place(axis.low);
  return NARROWEST * Math.max(whole, Math.abs(from), Math.abs(to));
}

/** What may be seen of an axis: its outermost places, and how near to each other they may come. */
export function boundsOfAxis(axis) {
  const [least, most] = axis.beyond.map(axis.place);
  return { least, most, narrowest: narrowestOf(axis, 0, 0) };
}

/** Ends of a window, moved into what an axis can have and not too near to each other. */
function within(axis, low, high) {
  const { least, most } = boundsOfAxis(axis);
  const [from, to] = [axis.place(low), axis.place(high)];
  const width = Math.min(Math.max(to - from, narrowestOf(axis, from, to)), most - least);
  if (from >= least && to <= most && width === to - from) return [low, high];
  const start = Math.min(Math.max(from, least), most - width);
  return [axis.value(start), axis.value(start + width)];
}

/** The window of a state, in the units of its axes: all of both, if none is chosen. */
export function windowOf(state, x, y) {
  const whole = [x.low, x.high, y.low, y.high];
  const { window } = state;
  if (!window) return whole;
  const overlaps = window[0] < x.beyond[1] && window[1] > x.beyond[0];
  if (!overlaps || !(window[2] < y.beyond[1] && window[3] > y.beyond[0])) return whole;
  return [...within(x, window[0], window[1]), ...within(y, window[2], window[3])];
}

/** Values in the middle of equal steps on the screen between two values of an axis. */
export function spreadOver(axis, low, high, side) {
  const [from, to] = [axis.place(low), axis.place(high)];
  const step = (to - from) / side;
  return Float64Array.from({ length: side }, (_, i) => axis.value(from + (i + 0.5) * step));
}

/**
 * For each of `side` steps across the screen the nearest of some values of an axis; −1 beyond them.
 * @param {ArrayLike<number>} values ascending
 */
export function nearestTo(axis, values, low, high, side) {
  const places = Float64Array.from(values, axis.place);
  const [from, to] = [axis.place(low), axis.place(high)];
  const half = 0.5 * (to - from) * 1e-9;
  const last = places.length - 1;
  const edge = (i, j) => (last > 0 ? 0.5 * (places[i] - places[j]) : 0);
  const least = places[0] - edge(1, 0) - half;
  const most = places[last] + edge(last, last - 1) + half;
  const found = new Int32Array(side);
  let at = 0;
  for (let i = 0; i < side; i++) {
    const place = from + ((i + 0.5) / side) * (to - from);
    while (at < last && places[at + 1] - place < place - places[at]) at++;
    found[i] = place < least || place > most ? -1 : at;
  }
  return found;
}

/**
 * The ends of a scale of colours: round numbers about nearly all of the values.
 * Values that run away to infinity, beyond so many medians, are cut at so many.
 */
export function endsOf(quantity, values, { running_away: away, cut_at: cut }) {
  const finite = [];
  const step = Math.max(1, Math.floor(values.length / 2500));
  for (let i = 0; i < values.length; i += step) {
    const inside = Number.isFinite(values[i]) && (quantity.name !== "critical_delay" || values[i]);
    if (inside) finite.push(values[i]);
  }
  if (finite.length === 0) return [0, 1];
  finite.sort((a, b) => a - b);
  const at = (share) => finite[Math.min(Math.floor(share * finite.length), finite.length - 1)];
  if (quantity.dtype === "uint8") return [Math.min(0, at(0)), Math.max(1, at(1))];
  const [low, middle, high] = [at(0.02), at(0.5), at(0.96)];
  if (low > 0 && high > away * middle) return [low, cut * middle];
  return [low, high];
}
