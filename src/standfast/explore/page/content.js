/** What the page was told when it was made: parameters, quantities, people, subjects. */

/** Words for numbers that JSON has not. */
const WORDS = { inf: Number.POSITIVE_INFINITY, "-inf": Number.NEGATIVE_INFINITY };

/** A number out of JSON: "inf" is infinite, null is none. Words of a choice stay words. */
export function decoded(value) {
  return value === null ? Number.NaN : (WORDS[value] ?? value);
}

/** What goes into JSON for a number or a word. */
export function encoded(value) {
  if (typeof value !== "number" || Number.isFinite(value)) return value;
  if (Number.isNaN(value)) return null;
  return value > 0 ? "inf" : "-inf";
}

/**
 * Read the content of the page; parameters and quantities are found by name, too.
 * @param {string} text the JSON
 */
export function contentOf(text) {
  const content = JSON.parse(text);
  for (const row of content.parameters) {
    for (const key of ["from", "to", "step", "start", "lowest", "highest"]) {
      if (row[key] !== undefined) row[key] = decoded(row[key]);
    }
    row.stops = (row.stops ?? []).map(decoded);
    row.choices ??= [];
    row.numeric = typeof row.start === "number";
  }
  for (const row of content.quantities) {
    row.limit = decoded(row.limit ?? null);
    row.seen = content.constants.seen[row.name];
  }
  for (const subject of content.subjects) {
    for (const [name, value] of Object.entries(subject.values)) {
      subject.values[name] = decoded(value);
    }
  }
  content.parameter = Object.fromEntries(content.parameters.map((row) => [row.name, row]));
  content.quantity = Object.fromEntries(content.quantities.map((row) => [row.name, row]));
  content.atlas = content.source !== "formulas";
  return content;
}

/** The parameters that can be an axis of the map. */
export function axesOf(content) {
  const kind = content.atlas ? "stops" : "range";
  return content.parameters.filter(
    (row) => row.numeric && row.kind === kind && (!content.atlas || finiteStops(row).length > 1),
  );
}

/** The values of an axis of an atlas that a map can show: not that of a rigid joint. */
export function finiteStops(row) {
  return Float64Array.from(row.stops.filter((value) => Number.isFinite(value)));
}

/** Whether the values of an axis rise by factors, not by steps. */
export function isLogarithmic(values) {
  if (values.length < 3 || !(values[0] > 0)) return false;
  const spread = (between) => {
    const found = Array.from(values.slice(1), (value, i) => between(value, values[i]));
    const most = Math.max(...found);
    return (most - Math.min(...found)) / most;
  };
  const steps = spread((next, value) => next - value);
  return steps > 1e-6 && spread((next, value) => Math.log(next / value)) <= 1e-6;
}

/** A number in at most four digits, with a proper minus. */
export function shortNumber(value, digits = 4) {
  if (value === Number.POSITIVE_INFINITY) return "∞";
  if (value === Number.NEGATIVE_INFINITY) return "−∞";
  if (typeof value !== "number" || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  const text =
    size !== 0 && (size >= 1e6 || size < 1e-4)
      ? value.toExponential(Math.min(digits - 1, 2)).replace(/\.?0*e\+?/, "·10^")
      : String(Number(value.toPrecision(digits)));
  return text.replaceAll("-", "−");
}

/** A number that was computed, in all of so many digits: what ends in 0 does so. */
export function measured(value, digits = 4) {
  const size = Math.abs(value);
  const text = size >= 1e-4 && Number.isFinite(size) ? value.toPrecision(digits) : "e";
  return text.includes("e") ? shortNumber(value, digits) : text.replace("-", "−");
}

/** A computed number with its unit. */
export function measuredUnit(value, unit, digits = 4) {
  return unit === "1" ? measured(value, digits) : `${measured(value, digits)} ${unit}`;
}

/** A number with its unit; a pure number has none. */
export function withUnit(value, unit, digits = 4) {
  return unit === "1" ? shortNumber(value, digits) : `${shortNumber(value, digits)} ${unit}`;
}

/** The value of a parameter in words: a number with its unit, "rigid", or the word that it is. */
export function valueWords(row, value) {
  if (typeof value !== "number") return String(value);
  return row.or_rigid && value === Number.POSITIVE_INFINITY ? "rigid" : withUnit(value, row.unit);
}

/** What a row is called, with a capital and its unit, as an axis label has it. */
export function labelOf(row) {
  const words = row.words[0].toUpperCase() + row.words.slice(1);
  return row.unit === "1" ? words : `${words} (${row.unit})`;
}
