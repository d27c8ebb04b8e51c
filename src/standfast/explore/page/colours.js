/** Colours of values: even to the eye, told apart by the colour-blind, readable in grey; pure. */

// cividis at 10 places, as the figures of the package; and two arms about a limit.
const EVEN = "00224e 123570 3b496c 575d6d 707173 8a8678 a59c74 c3b369 e1cc55 fee838";
const APART = "94400a b8560f d97b35 efb68c f6eee6 a9cfe6 5aa3d1 1f77b4 0a4a7d";
const FALLS = "e9a783";
const STANDS = "8fc0e0";

/** Number of colours of a scale. */
const SHADES = 256;

/** Pixels as an ImageData has them, in the byte order of all machines that run browsers. */
function pixel([red, green, blue]) {
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

function components(hex) {
  return [0, 2, 4].map((at) => Number.parseInt(hex.slice(at, at + 2), 16));
}

function scaleOf(text) {
  const stops = text.split(" ").map(components);
  return Array.from({ length: SHADES }, (_, i) => {
    const place = (i / (SHADES - 1)) * (stops.length - 1);
    const at = Math.min(Math.floor(place), stops.length - 2);
    return stops[at].map((low, c) => Math.round(low + (place - at) * (stops[at + 1][c] - low)));
  });
}

/** Lines of the hatching: dark on what is pale, pale on what is dark. */
function hatched([red, green, blue], dark) {
  const towards = dark ? 40 : 255;
  return [red, green, blue].map((part) => Math.round(part + 0.55 * (towards - part)));
}

function tableOf(text, darkAbove) {
  const colours = scaleOf(text);
  const light = ([red, green, blue]) => 0.3 * red + 0.59 * green + 0.11 * blue;
  const lines = colours.map((colour) => hatched(colour, light(colour) > darkAbove));
  return {
    colours,
    plain: Uint32Array.from(colours, pixel),
    hatched: Uint32Array.from(lines, pixel),
  };
}

const TABLES = { even: tableOf(EVEN, 125), apart: tableOf(APART, 0) };
const VERDICT = [FALLS, STANDS].map(components);
const DEEP = components("b24a00");

/** The colours of one map: ends of its scale, and the limit about which it goes apart. */
export function scaleFor(quantity, ends) {
  if (quantity.flags?.length) return { kind: "flags", low: 0, high: 1, limit: Number.NaN };
  const [low, high] = ends;
  const apart = quantity.limit > low && quantity.limit < high;
  const limit = apart ? quantity.limit : Number.NaN;
  const { infinite_falls: infiniteFalls } = quantity;
  return { kind: apart ? "apart" : "even", low, high, limit, infiniteFalls };
}

/** Where a value lies on a scale, from 0 to 1, or beyond. */
function shareOf(scale, value) {
  if (scale.kind !== "apart") return (value - scale.low) / (scale.high - scale.low);
  return value < scale.limit
    ? (0.5 * (value - scale.low)) / (scale.limit - scale.low)
    : 0.5 + (0.5 * (value - scale.limit)) / (scale.high - scale.limit);
}

/** The colour of a value as CSS has it. */
export function cssColour(scale, value) {
  if (scale.kind === "flags") return `rgb(${VERDICT[value > 0 ? 1 : 0].join(" ")})`;
  const share = Math.min(Math.max(shareOf(scale, value), 0), 1);
  return `rgb(${TABLES[scale.kind].colours[Math.round(share * (SHADES - 1))].join(" ")})`;
}

// A line of the hatching every so many pixels, so many wide.
const PERIOD = 12;
const WIDTH = 2;

/**
 * Paint values into an image of any size: each pixel takes the value that `columns` and `rows` name.
 * @param {Uint32Array} image row by row from below
 * @param {{values: ArrayLike<number>, width: number, columns: Int32Array, rows: Int32Array}} field
 * @param {{values: ArrayLike<number>, width: number, columns: Int32Array, rows: Int32Array}|null}
 *   standing 0 where the person falls, which is hatched
 * @returns {boolean} whether anything is hatched
 */
export function paint(image, field, standing, scale) {
  const [across, up] = [field.columns.length, field.rows.length];
  const bounds = boundsOf(scale);
  let any = false;
  for (let row = 0; row < up; row++) {
    const from = field.rows[row] * field.width;
    const offset = PERIOD - (row % PERIOD);
    const fromStanding = standing ? standing.rows[row] * standing.width : 0;
    for (let column = 0; column < across; column++) {
      // an index of -1 lies beyond what is known
      const beyond = from < 0 || field.columns[column] < 0;
      const value = beyond ? Number.NaN : field.values[from + field.columns[column]];
      const falls =
        (standing !== null && standing.values[fromStanding + standing.columns[column]] === 0) ||
        (scale.infiniteFalls && value === Number.POSITIVE_INFINITY);
      any ||= falls;
      const line = falls && (column + offset) % PERIOD < WIDTH;
      image[row * across + column] = shade(bounds, value, line);
    }
  }
  return any;
}

const NOTHING = pixel(components("b4b4b4"));
const FALLING = [pixel(VERDICT[0]), pixel(DEEP)];

function boundsOf(scale) {
  if (scale.kind === "flags") {
    const tables = [VERDICT.map(pixel), [pixel(DEEP), pixel(VERDICT[1])]];
    return { plain: tables[0], hatched: tables[1], limit: 0.5, low: 0, high: 1, flags: true };
  }
  const { plain, hatched: lines } = TABLES[scale.kind];
  const apart = scale.kind === "apart";
  const middle = apart ? (SHADES - 1) / 2 : 0;
  const limit = apart ? scale.limit : scale.low;
  return {
    ...{ plain, hatched: lines, limit, middle, flags: false },
    infinite: scale.infiniteFalls ? FALLING : null,
    below: apart ? middle / (limit - scale.low) : 0,
    above: (SHADES - 1 - middle) / (scale.high - limit),
  };
}

function shade(bounds, value, line) {
  if (Number.isNaN(value)) return NOTHING;
  if (bounds.flags) return (line ? bounds.hatched : bounds.plain)[value > 0 ? 1 : 0];
  if (bounds.infinite && value === Number.POSITIVE_INFINITY) return bounds.infinite[line ? 1 : 0];
  const away = value - bounds.limit;
  const at = bounds.middle + away * (away < 0 ? bounds.below : bounds.above);
  const index = at < 0 ? 0 : at > SHADES - 1 ? SHADES - 1 : (at + 0.5) | 0;
  return (line ? bounds.hatched : bounds.plain)[index];
}
