/** Values on the plane of the map, wherever they come from: one way to ask for all of them. */
import { Newest } from "./asking.js";
import { encoded } from "./content.js";
import { isCoupling, nervesOf } from "./facts.js";
import { fillPerson, slotOf } from "./state.js";

/** Points along a side of the map, at rest; fewer are taken while a slider moves and time is short. */
export const SIDE = 401;
const SIDES = [SIDE, 201, 101];
const SWAY_SIDE = 201; // of sway, which takes the program longest
const COARSE = 41; // of what the program computes while a slider moves
// ms, for the values of one picture while a slider moves; springs are to be drawn within 33
const BUDGET = { springs: 20, oneJoint: 60 };
const RECENT = 6; // planes, the quickest of which says what one takes
const STANDING_SIDE = 201;
const LIMIT_SIDE = 101;

const SPRINGS_ALONE = "needs the program (standfast explore); this map is of springs alone.";

/**
 * Planes of a content: `sample(state, window, spread, resting)` gives what the map shows.
 *
 * A grid is {values, xs, ys}: values[iy * xs.length + ix], xs and ys in the units of the axes.
 */
export class Planes {
  #content;
  #formulas;
  #cells;
  #live;
  #person;
  #buffers = new Map();
  #cost = new Map();

  /**
   * @param {object} cells where an atlas' planes are found (cells.js), or null
   * @param {(path: string, body: object) => Promise<Response>} ask the program, or null
   */
  constructor(content, formulas, { cells, ask, arrived }) {
    this.#content = content;
    this.#formulas = formulas;
    this.#cells = cells;
    this.#person = new Float64Array(formulas.slotCount);
    this.#live = ask && new Newest((question, signal) => askLive(ask, question, signal), arrived);
  }

  /** How the values of a quantity are found: "springs", "oneJoint", "live", "cells", or "". */
  way(state, name) {
    if (this.#content.atlas) return "cells";
    const { springs, oneJoint } = this.#formulas;
    const nerves = nervesOf(state, [state.x, state.y]);
    if (this.#content.quantity[name]?.of_noise) {
      const sways = nerves.noisy && (nerves.damped || nerves.gained);
      return this.#live && sways ? "live" : "";
    }
    const fedBack = name === "stable" || !(name in springs);
    if (name in springs && !(nerves.gained && fedBack)) return "springs";
    if (nerves.gained && nerves.free.length === 1 && name in oneJoint) return "oneJoint";
    if (this.#live) return "live";
    return name in springs ? "springs" : "";
  }

  /**
   * @param {number[]} window low and high of x and of y, in the units of the axes
   * @param {(low: number, high: number, side: number, axis: string) => Float64Array} spread
   *   points of an axis, in the middles of equal steps on the screen
   * @returns {{shown: object|null, standing: object|null, limit: object|null, pending: boolean,
   *   coarse: boolean, word: string, of?: object}} `of` is the state of values that came late
   */
  sample(state, window, spread, resting) {
    const name = state.quantity;
    const grid = (side) => ({
      xs: spread(window[0], window[1], side, "x"),
      ys: spread(window[2], window[3], side, "y"),
    });
    fillPerson(this.#content, this.#formulas.slots, state.values, this.#person);
    const ways = { shown: this.way(state, name), standing: this.way(state, "stable") };
    if (ways.shown === "cells") {
      const cells = this.#cells.sample(state, name);
      const gained = nervesOf(state, [state.x, state.y]).gained;
      // of springs alone the limit is known between the cells too
      return gained ? cells : { ...cells, limit: this.#limitOfSprings(state, grid) };
    }
    if (ways.shown === "") {
      const word = this.lacking(state, name).sentence;
      return { shown: null, standing: null, limit: null, pending: false, coarse: false, word };
    }
    const live = this.#askedLive(state, ways, grid, resting);
    const found = (way, of, side) =>
      way === "live" ? (live?.[of] ?? null) : this.#computed(state, way, of, grid(side));
    const side = resting ? SIDE : this.#affordable(ways.shown, this.#sort(state, ways.shown, name));
    const shown = found(ways.shown, name, side);
    const standing =
      name === "stable" ? shown : found(ways.standing, "stable", Math.min(side, STANDING_SIDE));
    const bySprings = ways.standing === "springs";
    const limit = bySprings
      ? this.#limitOfSprings(state, grid)
      : standing && { ...standing, level: 0.5 };
    const pending = live !== undefined && (live === null || live.stale);
    const word = live?.refused ?? (bySprings ? this.#wordOfSprings(state) : "");
    const coarse = side < SIDE || live?.coarse === true;
    const of = ways.shown === "live" && shown ? { ...live.state, quantity: name } : undefined;
    return { shown, standing, limit, pending, coarse, word, of };
  }

  /** What a quantity needs that is not there, as a word or two and in a sentence; null: nothing. */
  lacking(state, name) {
    if (this.way(state, name) !== "") return null;
    return lackOf(this.#content.quantity[name], nervesOf(state, [state.x, state.y]));
  }

  /** What a map of springs leaves out for want of the program. */
  #wordOfSprings(state) {
    const { gained, damped } = nervesOf(state, [state.x, state.y]);
    if (gained) return `Feedback of several joints ${SPRINGS_ALONE}`;
    return damped && !this.#live ? `What damping does ${SPRINGS_ALONE}` : "";
  }

  #limitOfSprings(state, grid) {
    const found = this.#computed(state, "springs", "safety_factor", grid(LIMIT_SIDE));
    return { ...found, level: 1 };
  }

  /** What decides how long a plane takes: coupled joints have other formulas. */
  #sort(state, way, name) {
    const coupled = this.#content.parameters.some(
      (row) => isCoupling(row) && state.values[row.name],
    );
    return `${way} ${name} ${coupled} ${state.x} ${state.y}`;
  }

  #affordable(way, sort) {
    const cost = Math.min(...(this.#cost.get(sort) ?? [0]));
    return SIDES.find((side) => cost * side * side <= (BUDGET[way] ?? 0)) ?? SIDES.at(-1);
  }

  /** One of two arrays in turn, so that what is drawn stays what it was until the next is drawn. */
  #buffer(key, size) {
    const [next, last] = this.#buffers.get(key) ?? [new Float64Array(size), new Float64Array(size)];
    this.#buffers.set(key, [last, next]);
    return next;
  }

  #computed(state, way, name, { xs, ys }) {
    const { slots } = this.#formulas;
    const values = this.#buffer(`${way} ${name} ${xs.length}`, xs.length * ys.length);
    const began = performance.now();
    const formula = this.#formulas[way][name];
    formula.plane(this.#person, slotOf(slots, state.x), xs, slotOf(slots, state.y), ys, values);
    const each = (performance.now() - began) / values.length;
    // the last few: the first run before the browser has compiled them, others while it is busy
    const sort = this.#sort(state, way, name);
    this.#cost.set(sort, [...(this.#cost.get(sort) ?? []).slice(1 - RECENT), each]);
    return { values, xs, ys };
  }

  /** Want values of the program; undefined where none are needed, null where none are there yet. */
  #askedLive(state, ways, grid, resting) {
    const wanted = [];
    if (ways.shown === "live") wanted.push(state.quantity);
    if (ways.standing === "live" && !wanted.includes("stable")) wanted.push("stable");
    if (wanted.length === 0) return undefined;
    const parameters = Object.fromEntries(
      Object.entries(state.values)
        .filter(([name]) => name !== state.x && name !== state.y)
        .map(([name, value]) => [name, encoded(value)]),
    );
    const ends = grid(2);
    const place = JSON.stringify([wanted, state.x, ends.xs, state.y, ends.ys, parameters]);
    // a coarse picture comes first, so that something is seen soon
    const fine = resting && this.#live.answer?.place === place;
    const sways = this.#content.quantity[state.quantity].of_noise;
    const { xs, ys } = grid(fine ? (sways ? SWAY_SIDE : SIDE) : COARSE);
    const question = {
      place,
      state: { ...state, values: { ...state.values } },
      body: {
        quantities: wanted,
        x: { name: state.x, values: Array.from(xs) },
        y: { name: state.y, values: Array.from(ys) },
        parameters,
      },
    };
    const key = `${place} ${xs.length}`;
    this.#live.want(key, question, { long: fine, place });
    const { answer } = this.#live;
    const refused = this.#live.refusal(key);
    if (refused !== undefined) {
      // no more will come: what is there of this place is all there is
      const here = answer?.place === place ? { ...answer.grids, state: answer.state } : {};
      return { ...here, refused, stale: false, coarse: false };
    }
    if (!answer || answer.x !== state.x || answer.y !== state.y) return null;
    const stale = this.#live.key !== key;
    return { ...answer.grids, state: answer.state, stale, coarse: !fine || stale };
  }
}

/** What a quantity needs for its values. */
function lackOf({ words, of_noise: ofNoise }, nerves) {
  const nerved = nerves.gained || nerves.damped;
  const program = (sentence) => ({
    needs: "the program",
    sentence: `${sentence} needs the program (standfast explore).`,
  });
  if (!ofNoise && nerved) {
    return program(`The ${words} with ${nerves.gained ? "this feedback" : "damping"}`);
  }
  if (!ofNoise) return { needs: "a gain", sentence: `The ${words} is of feedback: set a gain.` };
  if (!nerves.noisy) {
    const sentence = `The ${words} is of noise: set a noise of the torques.`;
    return { needs: "noise", sentence };
  }
  if (nerved) return program(`The ${words}`);
  return {
    needs: "damping or a gain",
    sentence: `The ${words} has no bounds, as nothing damps the person: set a damping or a gain.`,
  };
}

async function askLive(ask, { place, state, body }, signal) {
  const response = await ask("/live", body, signal);
  const all = new Float64Array(await response.arrayBuffer());
  const xs = Float64Array.from(body.x.values);
  const ys = Float64Array.from(body.y.values);
  const size = xs.length * ys.length;
  const grids = Object.fromEntries(
    body.quantities.map((name, i) => {
      return [name, { values: all.subarray(i * size, (i + 1) * size), xs, ys }];
    }),
  );
  return { place, state, x: body.x.name, y: body.y.name, grids };
}
