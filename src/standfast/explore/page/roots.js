/** The roots of the person's movement in the plane, in a small figure of Bokeh. */
import { shortNumber } from "./content.js";
import { setColumns } from "./plot.js";
import { marksOf } from "./ticks.js";

const NEAREST = 4;

/** The roots in their figure. */
export class RootPlane {
  #plot;
  #half = [0, 0];
  #shown = "";

  constructor(plot) {
    this.#plot = plot;
  }

  /** @param {number[][]} roots real parts (1/s) and imaginary parts (rad/s) */
  show(roots) {
    const key = JSON.stringify(roots);
    if (key === this.#shown) return;
    this.#shown = key;
    this.#plot.held(() => {
      // the frame holds all that grow, else those nearest to the middle: stiff joints ring far away
      const middle = roots.toSorted((a, b) => Math.hypot(...a) - Math.hypot(...b));
      const nearest = middle.filter(([re], i) => i < NEAREST || re > 0);
      const half = [0, 1].map((part) => {
        const most = Math.max(part ? 2 : 1, ...nearest.map((root) => Math.abs(root[part])));
        const kept = this.#half[part];
        // the frame stays while the roots move within it
        return most <= 0.95 * kept && most > 0.3 * kept ? kept : roundUp(1.2 * most);
      });
      if (half[0] !== this.#half[0] || half[1] !== this.#half[1]) this.#setFrame(half);
      for (const [name, inside] of [
        ["unstable", (re) => re > 0],
        ["stable", (re) => !(re > 0)],
      ]) {
        const some = roots.filter(([re]) => inside(re));
        setColumns(this.#plot.source(name), {
          x: some.map(([re]) => re),
          y: some.map(([, im]) => im),
        });
      }
    });
  }

  /** How many of some roots lie outside of the frame, in words. */
  beyond(roots) {
    const outside = roots.filter(
      ([re, im]) => Math.abs(re) > this.#half[0] || Math.abs(im) > this.#half[1],
    );
    const fastest = Math.max(...outside.map(([re, im]) => Math.hypot(re, im)));
    if (outside.length === 0) return "";
    return `Outside of the frame: ${outside.length} root${outside.length === 1 ? "" : "s"}, up to ${shortNumber(fastest, 3)} rad/s.`;
  }

  #setFrame(half) {
    this.#half = half;
    const [across, up] = half;
    this.#plot.setRanges([-across, across, -up, up]);
    this.#plot.setAxis("x", "Growth, real part (1/s)", marksOf(-across, across, false, 5));
    this.#plot.setAxis("y", "Imaginary part (rad/s)", marksOf(-up, up, false, 5));
  }
}

function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((factor) => factor * power >= value) * power;
}

/** The roots in words. */
export function rootWords(roots) {
  const growing = roots.filter(([re]) => re > 0).length;
  const count = (number, kind) => `${number} ${kind} root${number === 1 ? "" : "s"}`;
  return `Roots in the plane: ${count(growing, "growing")}, ${count(roots.length - growing, "other")}`;
}
