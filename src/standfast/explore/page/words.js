/** The person in words and numbers; pure. */
import { measured, measuredUnit, shortNumber, valueWords } from "./content.js";
import { JOINTS } from "./facts.js";

/** The verdict in one or two sentences. */
export function verdictWords(facts, fedBack, nerves) {
  if (facts.modes.length === 0) return "Stands: every joint is rigid.";
  if (fedBack && (nerves.gained || nerves.damped)) return fedBackWords(facts, fedBack, nerves);
  const alone = nerves.gained || nerves.damped ? " by springs alone" : "";
  return `${facts.stands ? "Stands" : "Falls"}${alone}. ${movement(facts)}; ${multiple(facts)}.`;
}

function movement({ stands, modes }) {
  const size = Math.sqrt(Math.abs(modes[0].eigenvalue));
  return stands
    ? `Its least stable movement sways at ${measured(size / (2 * Math.PI), 3)} Hz`
    : `The lean doubles in ${measured(Math.LN2 / size, 3)} s`;
}

function multiple({ stands, factor }) {
  if (stands) return `all stiffness could be divided by ${measured(factor, 3)}`;
  return factor > 0
    ? `all stiffness must be multiplied by ${measured(1 / factor, 3)}`
    : "no multiple of this stiffness suffices";
}

function fedBackWords(facts, fedBack, nerves) {
  const means = [nerves.damped ? "damping" : "", nerves.gained ? "feedback" : ""];
  const by = means.filter(Boolean).join(" and ");
  if (fedBack.stands === null) return `With ${by} the verdict is open within rounding.`;
  const parts = [`${fedBack.stands ? "Stands" : "Falls"} with ${by}.`];
  if (nerves.gained) parts.push(delayWords(fedBack));
  const [re, im] = fedBack.rightmost_root ?? [Number.NaN, 0];
  const time = measured(Math.LN2 / Math.abs(re), 3);
  if (re !== 0 && im > 0) {
    const sway = `A sway at ${measured(im / (2 * Math.PI), 3)} Hz`;
    parts.push(re < 0 ? `${sway} halves in ${time} s.` : `${sway} grows, doubling in ${time} s.`);
  } else if (re !== 0 && !Number.isNaN(re)) {
    parts.push(`The lean ${re < 0 ? "halves" : "doubles"} in ${time} s.`);
  }
  if (facts.stands !== fedBack.stands) {
    parts.push(`By springs alone it ${facts.stands ? "stands" : "falls"}.`);
  }
  return parts.filter(Boolean).join(" ");
}

function delayWords({ stands, critical_delay: critical, delay_margin: margin }) {
  if (critical === null || critical === undefined || Number.isNaN(critical)) return "";
  if (critical === 0) return stands ? "" : "Falls without any delay already.";
  if (critical === Number.POSITIVE_INFINITY) return "No delay ends it.";
  const later = stands && margin <= 0 ? " (a later window of standing)" : "";
  return `Critical delay ${measuredUnit(critical, "s")}, margin ${measuredUnit(margin, "s", 3)}${later}.`;
}

/** Why no movement is shown. */
export function movementWords(facts, fedBack, program, waiting) {
  if (facts.modes.length === 0) return "";
  if (waiting) return "The movement is being computed.";
  if (!program)
    return "With damping or feedback the movement needs the program (standfast explore).";
  return fedBack?.roots ? "Which movement is the least stable is open within rounding." : "";
}

/** What the map shows, for those who do not see it. */
export function mapWords(content, state, verdict, pending) {
  const name = (axis) => content.parameter[axis];
  const at = [state.x, state.y].map((axis) => {
    return `${name(axis).words} ${valueWords(name(axis), state.values[axis])}`;
  });
  const quantity = content.quantity[state.quantity];
  const shown = `Map of ${quantity.words} over ${name(state.x).words} and ${name(state.y).words}`;
  const here = verdict || "being computed.";
  return `${shown}${pending ? ", being computed" : ""}. At ${at.join(", ")}: ${here}`;
}

/** Each joint's stiffness beside its threshold, for the bars. */
export function jointRows(facts) {
  return JOINTS.map((joint, i) => {
    const [own, needed] = [facts.own[i], facts.thresholds[i]];
    const has = own === Number.POSITIVE_INFINITY ? "rigid" : shortNumber(own);
    const needs = Number.isFinite(needed)
      ? `needs ${measured(needed)}`
      : "cannot make up for the others";
    const soft = !(own > needed) && Number.isFinite(needed) ? " – too soft" : "";
    return { joint, own, needed, holds: own > needed, words: `${has}, ${needs}${soft}` };
  });
}

/**
 * The table of margins: [name, number with unit], and for feedback what is known of it.
 * With damping or feedback those of springs stand below a head, [words, ""].
 */
export function marginRows(facts, fedBack, nerves) {
  const rows = nerves.gained || nerves.damped ? [["By springs alone", ""]] : [];
  if (facts.modes.length > 0) {
    const [{ eigenvalue, turns }] = facts.modes;
    const size = Math.sqrt(Math.abs(eigenvalue));
    const ratio = (i) => (turns[0] === 0 ? Number.POSITIVE_INFINITY : turns[i] / turns[0]);
    rows.push(
      ["Safety factor", measuredUnit(facts.factor, "1")],
      ["Stiffness reserve", measuredUnit(facts.reserve, "N·m/rad")],
      eigenvalue > 0
        ? ["Frequency", measuredUnit(size / (2 * Math.PI), "Hz")]
        : ["Growth rate of the fall", measuredUnit(size, "1/s")],
      ["Hip per ankle rotation", measuredUnit(ratio(2), "1")],
      ["Knee per ankle rotation", measuredUnit(ratio(1), "1")],
    );
  }
  if (!fedBack) return rows;
  rows.push([nerves.gained ? "With feedback" : "With damping", ""]);
  const known = (value) => value !== null && value !== undefined && !Number.isNaN(value);
  const add = (name, value, unit) => known(value) && rows.push([name, measuredUnit(value, unit)]);
  if (nerves.gained) {
    // of damping alone there is no delay
    add("Critical delay", fedBack.critical_delay, "s");
    add("Delay margin", fedBack.delay_margin, "s");
  }
  if (known(fedBack.unstable_roots)) {
    rows.push(["Unstable roots", String(fedBack.unstable_roots)]);
  }
  if (fedBack.rightmost_root) {
    const [re, im] = fedBack.rightmost_root;
    add("Decay rate", -re, "1/s");
    if (im > 0) add("Sway frequency", im / (2 * Math.PI), "Hz");
  }
  return rows;
}
