/** The map: an image of values in a figure of Bokeh, with contours, the limit, and the point. */
import { paint, scaleFor } from "./colours.js";
import { labelOf, shortNumber } from "./content.js";
import { contourLines, labelPlaces } from "./contours.js";
import { boundsOfAxis, endsOf, nearestTo } from "./frame.js";
import { setColumns } from "./plot.js";
import { marksOf, roundEnds, roundNumbers } from "./ticks.js";

/** Pixels along a side of the image. */
const PIXELS = 401;
const CONTOUR_POINTS = 101;
const LIMIT_POINTS = 401;
const LEVELS = 8;

/** The map in its figure: `show` draws what it is given, at once. */
export class StandingMap {
  #plot;
  #constants;
  #image = new Uint32Array(PIXELS * PIXELS);
  #array = null;
  #framed = "";
  #marked = {};
  /** What was drawn last, for downloads. */
  drawn = null;

  /**
   * @param {object} plot a figure (plot.js) with the sources of the map
   * @param {object} constants what the page has in common with the package
   */
  constructor(plot, constants) {
    this.#plot = plot;
    this.#constants = constants;
    // the reader may have moved it to where no window can be
    plot.onMove(() => this.resized());
  }

  /**
   * @param {object} wanted sample of planes with the state it is of, x and y axes, window,
   *   quantity, point, subjects
   * @returns {object} what is drawn, with the quantity and the scale of its colours
   */
  show(wanted) {
    const picture = inItsUnit(this.#there(wanted));
    const { sample, x, y, window } = picture;
    const frame = [x.place(window[0]), x.place(window[1]), y.place(window[2]), y.place(window[3])];
    this.#plot.held(() => {
      this.#setFrame(picture, frame);
      const scale = this.#paint(picture, frame);
      this.#draw(picture, frame, scale);
      this.drawn = { ...picture, scale: sample.shown ? scale : null };
    });
    return this.drawn;
  }

  /** While values are on their way what was there stays, if it has the same axes. */
  #there(picture) {
    const { drawn } = this;
    if (picture.sample.shown || !picture.sample.pending || !drawn?.sample.shown) return picture;
    if (drawn.x.row !== picture.x.row || drawn.y.row !== picture.y.row) return picture;
    const { sample, quantity, state } = drawn;
    return { ...picture, sample, quantity, state };
  }

  /** The figure has another size or place than was set, so that its axes must be set again. */
  resized() {
    this.#framed = "";
  }

  #setFrame({ x, y }, frame) {
    const key = `${x.row.name} ${y.row.name} ${frame}`;
    if (key === this.#framed) return;
    this.#framed = key;
    this.#plot.setBounds(boundsOfAxis(x), boundsOfAxis(y));
    this.#plot.setRanges(frame);
    const size = this.#plot.size();
    this.#plot.setAxis("x", labelOf(x.row), marksOf(frame[0], frame[1], x.logarithmic, size[0]));
    this.#plot.setAxis("y", labelOf(y.row), marksOf(frame[2], frame[3], y.logarithmic, size[1]));
  }

  #paint({ sample, seen, x, y, window }, frame) {
    const { quantity } = seen;
    const indices = (grid) => ({
      values: grid.values,
      width: grid.xs.length,
      columns: nearestTo(x, grid.xs, window[0], window[1], PIXELS),
      rows: nearestTo(y, grid.ys, window[2], window[3], PIXELS),
    });
    const shown = seen.shown ?? nothingOn(window);
    const ends = endsOf(quantity, shown.values, this.#constants);
    const scale = scaleFor(quantity, quantity.dtype === "uint8" ? ends : roundEnds(...ends));
    const field = indices(shown);
    const standing =
      sample.standing === seen.shown ? field : sample.standing && indices(sample.standing);
    scale.hatched = paint(this.#image, field, standing, scale);
    const [x0, x1, y0, y1] = frame;
    const source = this.#plot.source("image");
    this.#array ??= this.#plot.imageOf(this.#image, PIXELS);
    setColumns(source, { image: [this.#array], x: [x0], y: [y0], dw: [x1 - x0], dh: [y1 - y0] });
    return scale;
  }

  #draw(picture, frame, scale) {
    const { sample, x, y, point, subjects } = picture;
    const pointAt = place(point, x, y);
    const marks = subjects
      .map((subject) => ({ ...place(subject.values, x, y), label: subject.label }))
      .filter((mark) => Number.isFinite(mark.x) && Number.isFinite(mark.y));
    const there = Number.isFinite(pointAt.x) && Number.isFinite(pointAt.y);
    const limit = sample.limit ? lines(sample.limit, x, y, sample.limit.level, LIMIT_POINTS) : [];
    const contours = sample.shown ? contoursOf(picture, scale) : [];
    const taken = [...marks, ...(there ? [pointAt] : []), ...limit.flatMap(sparse)];
    const labels = labelPlaces(contours, frame, taken);
    const plot = this.#plot;
    setColumns(plot.source("contours"), columnsOf(contours));
    setColumns(plot.source("limit"), columnsOf(limit));
    setColumns(plot.source("labels"), {
      x: labels.map((label) => label.x),
      y: labels.map((label) => label.y),
      text: labels.map((label) => label.text),
    });
    this.#setMarks("point", { x: there ? [pointAt.x] : [], y: there ? [pointAt.y] : [] });
    this.#setMarks("subjects", {
      x: marks.map((mark) => mark.x),
      y: marks.map((mark) => mark.y),
      label: marks.map((mark) => mark.label),
    });
  }

  /** Set what seldom changes while a slider moves. */
  #setMarks(name, columns) {
    const key = JSON.stringify(columns);
    if (this.#marked[name] === key) return;
    this.#marked[name] = key;
    setColumns(this.#plot.source(name), columns);
  }
}

const scaledValues = new WeakMap();

/** A picture with what is `seen` of its values: in the unit in which the field reads them. */
function inItsUnit(picture) {
  const { sample, quantity } = picture;
  if (!quantity.seen || !sample.shown) {
    return { ...picture, seen: { shown: sample.shown, quantity } };
  }
  const { unit, factor } = quantity.seen;
  const { values } = sample.shown;
  const scaled = scaledValues.get(values) ?? values.map((value) => factor * value);
  scaledValues.set(values, scaled);
  const shown = { ...sample.shown, values: scaled };
  return { ...picture, seen: { shown, quantity: { ...quantity, unit } } };
}

/** One cell without a value. */
function nothingOn(window) {
  return { values: [Number.NaN], xs: [window[0]], ys: [window[2]] };
}

/** A few points of a line, which labels keep away from. */
function sparse({ xs, ys }) {
  const step = Math.max(1, Math.floor(xs.length / 25));
  return xs.map((x, i) => ({ x, y: ys[i] })).filter((_, i) => i % step === 0);
}

function place(values, x, y) {
  const at = (axis) => axis.place(values[axis.row.name] ?? Number.NaN);
  return { x: at(x), y: at(y) };
}

function columnsOf(drawn) {
  return { xs: drawn.map((line) => line.xs), ys: drawn.map((line) => line.ys) };
}

function lines(grid, x, y, level, most) {
  const stride = Math.max(1, Math.ceil(Math.max(grid.xs.length, grid.ys.length) / most));
  const [xs, ys] = [grid.xs.map(x.place), grid.ys.map(y.place)];
  return contourLines(grid.values, xs, ys, level, stride);
}

function contoursOf({ seen, x, y }, scale) {
  const { quantity } = seen;
  if (quantity.dtype === "uint8" || quantity.jumps) return [];
  const levels = roundNumbers(scale.low, scale.high, LEVELS);
  const apart = 1e-9 * (scale.high - scale.low);
  return levels
    .filter((level) => level > scale.low && level < scale.high)
    .filter((level) => !(Math.abs(level - quantity.limit) <= apart))
    .flatMap((level) => {
      const text = shortNumber(level);
      return lines(seen.shown, x, y, level, CONTOUR_POINTS).map((line) => ({ ...line, text }));
    });
}
