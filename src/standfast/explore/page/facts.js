/** What is known of the reader's person: springs from the formulas, feedback as far as it is had. */

export const JOINTS = ["ankle", "knee", "hip"];

/** Names of the gains among some parameters. */
export function isGain(name) {
  return name.endsWith("_gain");
}

/** Whether a parameter is a stiffness between two joints. */
export function isCoupling({ name, section }) {
  return section === "stiffness" && !JOINTS.some((joint) => name === `${joint}_stiffness`);
}

/**
 * What nerves do in a state: any gain, any damping, noise of a joint that turns, and the joints that
 * are free to.
 */
export function nervesOf(state, axes = []) {
  const names = Object.keys(state.values);
  const active = (name) => axes.includes(name) || (state.values[name] ?? 0) !== 0;
  const free = JOINTS.filter((joint) => {
    const name = `${joint}_stiffness`;
    return axes.includes(name) || state.values[name] !== Number.POSITIVE_INFINITY;
  });
  return {
    gained: names.some((name) => isGain(name) && active(name)),
    damped: names.some((name) => name.endsWith("_damping") && active(name)),
    noisy: free.some((joint) => active(`${joint}_noise`)),
    free,
  };
}

/**
 * What springs alone decide: verdict, margins, thresholds and modes of one person.
 * @param {object} formulas springs, slots and modesAt
 * @param {Float64Array} person
 */
export function springFacts(formulas, person) {
  const { springs, slots } = formulas;
  const found = formulas.modesAt(person);
  const modes = [0, 1, 2]
    .map((i) => ({ eigenvalue: found[i], turns: found.slice(3 + 3 * i, 6 + 3 * i) }))
    .filter((mode) => Number.isFinite(mode.eigenvalue));
  return {
    stands: springs.stable.at(person) === 1,
    factor: springs.safety_factor.at(person),
    reserve: springs.stiffness_reserve.at(person),
    own: JOINTS.map((joint) => person[slots[`${joint}_stiffness`]]),
    thresholds: JOINTS.map((joint) => springs[`critical_${joint}_stiffness`].at(person)),
    modes,
  };
}

/** What the formulas know of feedback at one free joint; null where they do not hold. */
export function oneJointFacts(formulas, person, nerves) {
  if (!nerves.gained || nerves.free.length !== 1) return null;
  const { oneJoint } = formulas;
  return {
    stands: oneJoint.stable.at(person) === 1,
    critical_delay: oneJoint.critical_delay.at(person),
    delay_margin: oneJoint.delay_margin.at(person),
    unstable_roots: oneJoint.unstable_roots.at(person),
  };
}

/**
 * How the person moves: a root in 1/s, and the complex rotation of each joint; null if unknown.
 * The largest rotation of a joint, or lean of a segment, is 1.
 */
export function movementOf(facts, fedBack, nerves) {
  if (fedBack?.shape && fedBack.rightmost_root) {
    return { root: fedBack.rightmost_root, turns: scaled(fedBack.shape) };
  }
  // springs alone move otherwise than with damping or feedback
  if (facts.modes.length === 0 || nerves.gained || nerves.damped) return null;
  const { eigenvalue, turns } = facts.modes[0];
  const size = Math.sqrt(Math.abs(eigenvalue));
  return {
    root: eigenvalue > 0 ? [0, size] : [size, 0],
    turns: scaled(Array.from(turns, (turn) => [turn, 0])),
  };
}

function scaled(turns) {
  const lean = [0, 0];
  const sizes = turns.flatMap(([re, im]) => {
    lean[0] += re;
    lean[1] += im;
    return [Math.hypot(re, im), Math.hypot(...lean)];
  });
  const largest = Math.max(...sizes, 1e-300);
  return turns.map(([re, im]) => [re / largest, im / largest]);
}

/** The characteristic roots to be drawn, both of each pair; with feedback those that are known. */
export function rootsOf(facts, fedBack, nerves) {
  if (!fedBack?.roots && (nerves.gained || nerves.damped)) return [];
  const pairs = fedBack?.roots
    ? fedBack.roots
    : facts.modes.map(({ eigenvalue }) => {
        const size = Math.sqrt(Math.abs(eigenvalue));
        return eigenvalue > 0 ? [0, size] : [size, 0];
      });
  const mirrored = fedBack?.roots
    ? pairs.filter(([, im]) => im !== 0).map(([re, im]) => [re, -im])
    : pairs.map(([re, im]) => [-re, -im]);
  return [...pairs, ...mirrored];
}

/**
 * Lengths of shank, thigh and what lies above the hip (m), for drawing.
 * @param {number} ankleHeight of the ankle above the floor, a fraction of stature
 */
export function lengthsOf(body, height, ankleHeight) {
  const [shank, thigh] = [body[6], body[7]];
  const upper = height ? height * (1 - ankleHeight) - shank - thigh : 2 * body[10];
  return [shank, thigh, Math.max(upper, 0.2)];
}
