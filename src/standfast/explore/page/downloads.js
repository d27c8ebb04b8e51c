/** What the reader takes home: files with names, the numbers of the map, and the person. */
import { encoded } from "./content.js";

/** Hand a text or a blob to the reader as a file. */
export function save(name, content, type) {
  const blob = content instanceof Blob ? content : new Blob([content], { type });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const LONGEST_NAME = 50; // letters of a title in a file's name

/** The name of a file: of what page, and of what in it; pure. */
export function fileName(content, what, ending) {
  const [title, rest] = [content.title, what].map((words) => {
    const letters = words.normalize("NFC").toLowerCase().slice(0, LONGEST_NAME);
    return letters.replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-+|-+$/g, "");
  });
  return `${title || "standing"}-${rest}.${ending}`;
}

/** The values of the map as CSV, below lines that name all that is fixed; pure. */
export function csvOf(content, state, grid) {
  const quantity = content.quantity[state.quantity];
  const lines = [`# ${quantity.words}: ${quantity.meaning}`];
  for (const row of content.parameters) {
    if (row.name === state.x || row.name === state.y) continue;
    lines.push(`# ${row.name} = ${exactly(row, state.values[row.name])}`);
  }
  lines.push(`# made by standfast ${content.version}`);
  const named = (row) => (row.unit === "1" ? row.name : `${row.name} (${row.unit})`);
  const heads = [content.parameter[state.x], content.parameter[state.y], quantity];
  lines.push(heads.map(named).join(","));
  const { values, xs, ys } = grid;
  for (let row = 0; row < ys.length; row++) {
    for (let column = 0; column < xs.length; column++) {
      const value = encoded(values[row * xs.length + column]) ?? "nan";
      lines.push(`${xs[column]},${ys[row]},${value}`);
    }
  }
  return `${lines.join("\n")}\n`;
}

/** A value in all its digits, as a program can read it. */
function exactly(row, value) {
  if (row.or_rigid && value === Number.POSITIVE_INFINITY) return "rigid";
  return row.numeric && row.unit !== "1" ? `${encoded(value)} ${row.unit}` : String(encoded(value));
}

/** The person as JSON: what is given, in SI units, and what was found; pure. */
export function personJson(content, state, facts, fedBack) {
  const given = Object.fromEntries(
    Object.entries(state.values).map(([name, value]) => [name, encoded(value)]),
  );
  const found = {
    stands_by_springs: facts.stands,
    safety_factor: facts.factor,
    stiffness_reserve: facts.reserve,
    critical_stiffness: Array.from(facts.thresholds),
    modes: facts.modes.map(({ eigenvalue, turns }) => ({ eigenvalue, turns: Array.from(turns) })),
    ...(fedBack ? { with_feedback: fedBack } : {}),
  };
  const plain = (_, value) => (typeof value === "number" ? encoded(value) : value);
  return JSON.stringify({ standfast: content.version, given, found }, plain, 2);
}
