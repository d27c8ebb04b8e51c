/** Planes of an atlas: embedded in the page, or read by the program that serves it. */
import { Newest } from "./asking.js";

const TYPES = { float64: Float64Array, float32: Float32Array, uint8: Uint8Array };
const KEPT_BYTES = 2 ** 28; // of planes
const SHOWN_AT_ONCE = 2; // a quantity and the verdict, which are kept however large

/** Planes of an atlas, whose axes have stops; asked for at the reader's stops of all others. */
export class Cells {
  #content;
  #whole;
  #newest;
  #kept = new Map();
  #bytes = 0;
  #verdicts = new WeakMap();

  /** @param {object|null} whole values of an embedded atlas by quantity, decoded */
  constructor(content, { whole, ask, arrived }) {
    this.#content = content;
    this.#whole = whole;
    this.#newest = ask && new Newest((planes) => this.#read(ask, planes), arrived);
  }

  /** What the map shows: the plane of a quantity, the verdict's, and where the limit lies. */
  sample(state, name) {
    const names = [name];
    if (name !== "stable" && "stable" in this.#content.quantity) names.push("stable");
    const planes = names.map((each) => this.#planeAt(state, each));
    const missing = planes.filter((plane) => !this.#kept.has(plane.key));
    let refused;
    if (missing.length > 0 && this.#whole) {
      for (const plane of missing) this.#keep(plane, this.#cut(plane));
    } else if (missing.length > 0) {
      const key = missing.map((plane) => plane.key).join();
      const place = planes.map((plane) => plane.key).join();
      this.#newest.want(key, missing, { place });
      refused = this.#newest.refusal(key);
    }
    const [shown, stable] = planes.map((plane) => this.#found(plane.key));
    const standing = name === "stable" ? shown : (stable ?? null);
    const { limit } = this.#content.quantity[name];
    const own = shown && Number.isFinite(limit) ? { ...shown, level: limit } : null;
    // the verdict before a value: beyond its critical delay a person may stand again
    const byVerdict = standing && { ...standing, level: 0.5 };
    const judged = standing ?? (own && name !== "delay_margin" ? this.#judged(own) : null);
    const lacking = missing.some((plane) => !this.#kept.has(plane.key));
    const pending = lacking && refused === undefined;
    const word = lacking ? (refused ?? "") : "";
    return { shown, standing: judged, limit: byVerdict ?? own, pending, coarse: false, word };
  }

  /** Who stands by a value above its limit, 1, or falls, 0: of an atlas without the verdict. */
  #judged({ values, xs, ys, level }) {
    if (!this.#verdicts.has(values)) {
      this.#verdicts.set(
        values,
        Uint8Array.from(values, (value) => (value > level ? 1 : 0)),
      );
    }
    return { values: this.#verdicts.get(values), xs, ys };
  }

  /** A plane that is kept; it is then the last to be dropped. */
  #found(key) {
    const plane = this.#kept.get(key);
    if (!plane) return null;
    this.#kept.delete(key);
    this.#kept.set(key, plane);
    return plane;
  }

  #planeAt(state, quantity) {
    const { axes } = this.#content.quantity[quantity];
    const at = {};
    for (const axis of axes) {
      if (axis === state.x || axis === state.y) continue;
      at[axis] = this.#content.parameter[axis].stops.indexOf(state.values[axis]);
    }
    const plane = { quantity, x: state.x, y: state.y, at };
    return { ...plane, key: JSON.stringify(plane) };
  }

  #keep({ key, x, y }, values) {
    const stops = [x, y].map((axis) => this.#content.parameter[axis].stops);
    const plane = withoutInfinite(values, ...stops);
    this.#kept.set(key, plane);
    this.#bytes += plane.values.byteLength;
    for (const [old, { values: dropped }] of this.#kept) {
      if (this.#bytes <= KEPT_BYTES || this.#kept.size <= SHOWN_AT_ONCE) break;
      this.#kept.delete(old);
      this.#bytes -= dropped.byteLength;
    }
  }

  async #read(ask, planes) {
    for (const plane of planes) {
      if (this.#kept.has(plane.key)) continue;
      const { quantity, x, y, at } = plane;
      const response = await ask("/atlas", { quantity, x, y, at });
      const Type = TYPES[this.#content.quantity[quantity].dtype];
      this.#keep(plane, new Type(await response.arrayBuffer()));
    }
    return planes;
  }

  #cut({ quantity, x, y, at }) {
    const { axes } = this.#content.quantity[quantity];
    const lengths = axes.map((axis) => this.#content.parameter[axis].stops.length);
    let stride = 1;
    const strides = {};
    for (let i = axes.length - 1; i >= 0; i--) {
      strides[axes[i]] = stride;
      stride *= lengths[i];
    }
    const start = Object.entries(at).reduce((sum, [axis, i]) => sum + strides[axis] * i, 0);
    const [across, up] = [x, y].map((axis) => this.#content.parameter[axis].stops.length);
    const whole = this.#whole[quantity];
    const values = new whole.constructor(across * up);
    for (let row = 0; row < up; row++) {
      for (let column = 0; column < across; column++) {
        // an axis on which it does not depend has no stride
        const from = start + row * (strides[y] ?? 0) + column * (strides[x] ?? 0);
        values[row * across + column] = whole[from];
      }
    }
    return values;
  }
}

function withoutInfinite(values, xStops, yStops) {
  const kept = [xStops, yStops].map((stops) =>
    stops.map((_, i) => i).filter((i) => Number.isFinite(stops[i])),
  );
  const [columns, rows] = kept;
  const xs = Float64Array.from(columns, (i) => xStops[i]);
  const ys = Float64Array.from(rows, (i) => yStops[i]);
  if (xs.length === xStops.length && ys.length === yStops.length) return { values, xs, ys };
  const finite = new values.constructor(xs.length * ys.length);
  rows.forEach((row, j) => {
    columns.forEach((column, i) => {
      finite[j * xs.length + i] = values[row * xStops.length + column];
    });
  });
  return { values: finite, xs, ys };
}

/** Decode the values of an embedded atlas: base64 of zlib. */
export async function embeddedValues(content) {
  const decode = async ([name, text]) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const inflated = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const Type = TYPES[content.quantity[name].dtype];
    return [name, new Type(await new Response(inflated).arrayBuffer())];
  };
  return Object.fromEntries(await Promise.all(Object.entries(content.embedded.values).map(decode)));
}
