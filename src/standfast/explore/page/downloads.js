/** What the reader takes home: the figure, the numbers of the map, and the person. */
import { drawBar } from "./bar.js";
import { encoded, valueWords } from "./content.js";

/** Hand a text or a blob to the reader as a file. */
export function save(name, content, type) {
  const blob = content instanceof Blob ? content : new Blob([content], { type });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
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

/** The map with its bar of colours and what is fixed, as a picture. */
export function pictureOf(canvas, quantity, scale, words, look) {
  const picture = document.createElement("canvas");
  const ratio = globalThis.devicePixelRatio || 1;
  const width = canvas.width / ratio;
  const foot = 54 + 18 * words.length + 10;
  picture.width = canvas.width;
  picture.height = canvas.height + foot * ratio;
  const context = picture.getContext("2d");
  context.fillStyle = look.ground;
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(canvas, 0, 0);
  context.scale(ratio, ratio);
  context.translate(0, canvas.height / ratio + 4);
  if (scale) drawBar(context, width, quantity, scale, look);
  context.fillStyle = look.ink;
  context.textAlign = "left";
  words.forEach((line, i) => {
    context.fillText(line, 26, 54 + 16 * (i + 1), width - 40);
  });
  return new Promise((done) => {
    picture.toBlob(done, "image/png");
  });
}

/** What is fixed, in lines of some length; pure. */
export function fixedWords(content, state, length = 100) {
  const parts = content.parameters
    .filter((row) => row.name !== state.x && row.name !== state.y)
    .filter((row) => !(row.start === 0 && state.values[row.name] === 0))
    .map((row) => `${row.words} ${valueWords(row, state.values[row.name])}`);
  const lines = [""];
  for (const part of parts) {
    const longer = lines.at(-1) ? `${lines.at(-1)}, ${part}` : part;
    if (longer.length > length && lines.at(-1)) lines.push(part);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}
