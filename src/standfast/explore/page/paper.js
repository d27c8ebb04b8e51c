/** The map as a figure for paper: as wide as a column, whatever the window of the reader. */
import { drawBar } from "./bar.js";
import { valueWords } from "./content.js";
import { StandingMap } from "./map.js";
import { Plot } from "./plot.js";

/** Size in the units of a screen; letters of 12 are 7 points where a column is 90 mm wide. */
const PAPER_WIDE = 420;
const PAPER_TALL = 400;
const PAPER_PIXELS = 3; // across each unit: 1260 in all, 350 to an inch of a column
const PAPER_MARGIN = 12;
const PAPER_BAR = 54;
const PAPER_LINE = 16;
const PAPER_LOOK = {
  ground: "#ffffff",
  ink: "#111111",
  line: "#8d949c",
  panel: "#ececec",
  font: "system-ui, sans-serif",
};

/** The map a second time, out of sight, drawn when it is taken home. */
export class PaperMap {
  #item;
  #plot = null;
  #map = null;

  /** @param {object} item the figure of the map as Bokeh's json_item gives it */
  constructor(item) {
    this.#item = item;
  }

  /**
   * The picture of what a map has drawn, as a PNG.
   * @param {object} content
   * @param {object} drawn of a map (map.js)
   */
  async picture(content, drawn) {
    await this.#made(content);
    this.#map.show(drawn);
    // it is painted in a chain of microtasks, which all run before the next task
    await new Promise((done) => setTimeout(done));
    const { seen, scale, state } = drawn;
    const words = fixedParts(content, state);
    return paperPicture(this.#plot.layers(), seen.quantity, scale, content.title, words);
  }

  async #made(content) {
    if (this.#plot) return;
    const place = document.createElement("div");
    Object.assign(place, { className: "paper", inert: true });
    Object.assign(place.style, { width: `${PAPER_WIDE}px`, height: `${PAPER_TALL}px` });
    document.body.append(place);
    this.#plot = await Plot.of(this.#item, place);
    this.#plot.sharpen(PAPER_PIXELS);
    this.#plot.paintAs(PAPER_LOOK);
    this.#map = new StandingMap(this.#plot, content.constants);
  }
}

function paperPicture(layers, quantity, scale, title, parts) {
  const picture = document.createElement("canvas");
  const context = picture.getContext("2d");
  const font = (size, weight = "") => `${weight} ${size}px ${PAPER_LOOK.font}`;
  context.font = font(11);
  const width = PAPER_WIDE - 2 * PAPER_MARGIN;
  const lines = wrapped(parts, width, (text) => context.measureText(text).width);
  context.font = font(13, "600");
  const heads = wrapped(title.split(" "), width, (text) => context.measureText(text).width, " ");
  const top = 8 + 18 * heads.length;
  picture.width = PAPER_WIDE * PAPER_PIXELS;
  picture.height =
    (top + PAPER_TALL + PAPER_BAR + PAPER_LINE * lines.length + PAPER_MARGIN) * PAPER_PIXELS;
  context.scale(PAPER_PIXELS, PAPER_PIXELS);
  context.fillStyle = PAPER_LOOK.ground;
  context.fillRect(0, 0, PAPER_WIDE, picture.height);
  for (const layer of layers) context.drawImage(layer, 0, top, PAPER_WIDE, PAPER_TALL);
  context.fillStyle = PAPER_LOOK.ink;
  context.font = font(13, "600");
  heads.forEach((line, i) => {
    context.fillText(line, PAPER_MARGIN, 20 + 18 * i);
  });
  context.translate(0, top + PAPER_TALL);
  if (scale) drawBar(context, PAPER_WIDE, quantity, scale, PAPER_LOOK);
  context.font = font(11);
  context.fillStyle = PAPER_LOOK.ink;
  context.textAlign = "left";
  lines.forEach((line, i) => {
    context.fillText(line, PAPER_MARGIN, PAPER_BAR + PAPER_LINE * (i + 1) - 4);
  });
  return new Promise((done) => {
    picture.toBlob(done, "image/png");
  });
}

/** What is fixed on a map, and where its ring stands, in words. */
function fixedParts(content, state) {
  const said = (row) => `${row.words} ${valueWords(row, state.values[row.name])}`;
  const isAxis = (row) => row.name === state.x || row.name === state.y;
  const ring = content.parameters.filter(isAxis).map(said);
  const fixed = content.parameters
    .filter((row) => !isAxis(row) && !(row.start === 0 && state.values[row.name] === 0))
    .map(said);
  const isOnMap = [state.x, state.y].every((axis) => Number.isFinite(state.values[axis]));
  return isOnMap ? [...fixed, `ring: ${ring[0]}`, ring[1]] : fixed;
}

/** Parts put together in lines that are no wider than a width, but for a part that is itself. */
function wrapped(parts, width, measured, between = ", ") {
  const lines = [];
  for (const part of parts) {
    const longer = lines.length ? `${lines.at(-1)}${between}${part}` : part;
    if (lines.length && measured(longer) <= width) lines[lines.length - 1] = longer;
    else lines.push(part);
  }
  return between === ", " ? lines.map((line, i) => (lines[i + 1] ? `${line},` : line)) : lines;
}
