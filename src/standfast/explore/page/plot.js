/** A figure of Bokeh that is drawn when we say so, in the colours of the page. */

/** Replace columns of a source of Bokeh; those that are given have one length. */
export function setColumns(source, columns) {
  const { data } = source;
  for (const [name, values] of Object.entries(columns)) {
    if (data instanceof Map) data.set(name, values);
    else data[name] = values;
  }
  // not by assignment, which compares all old values with all new ones
  source.change.emit();
}

// More than Bokeh needs; were they too few, it would draw by itself a little later.
const MICROTASKS = 80;

/** One figure of Bokeh in an element of the page. */
export class Plot {
  #view;
  #model;
  #quiet = false;
  #reframed = false;
  #sources = new Map();

  /** @param {object} item a figure as Bokeh's json_item gives it */
  static async of(item, element) {
    const views = await globalThis.Bokeh.embed.embed_item(item, element);
    const view = [...views][0] ?? views;
    return new Plot(view);
  }

  constructor(view) {
    this.#view = view;
    this.#model = view.model;
    // who comes by keyboard finds the element around it, which has a name
    view.canvas_view.events_el.removeAttribute("tabindex");
  }

  /** The source of a name. */
  source(name) {
    if (!this.#sources.has(name)) {
      this.#sources.set(name, this.#model.document.get_model_by_name(name));
    }
    return this.#sources.get(name);
  }

  /** Pixels of an image, as an array of Bokeh that looks into their memory: a copy would not change. */
  imageOf(pixels, side) {
    const { data } = this.source("image");
    const [old] = data instanceof Map ? data.get("image") : data.image;
    return new old.constructor(pixels.buffer, [side, side]);
  }

  /**
   * Do several changes, and draw once, before the browser paints its frame: what changed alone, and
   * the axes only in a new frame.
   */
  async held(change) {
    this.#quiet = true;
    this.#view.pause();
    try {
      change();
    } finally {
      this.#quiet = false;
    }
    // Bokeh takes up the columns in a chain of microtasks, which all run before the next task
    for (let i = 0; i < MICROTASKS; i++) await null;
    this.#view.unpause(true);
    if (this.#reframed) this.#view.repaint();
    else {
      // new columns move no axis here, so their labels need not be measured
      this.#view.invalidate_dataranges = false;
      this.#view.paint();
    }
    this.#reframed = false;
  }

  /** About how many marks fit along x and y. */
  size() {
    const { width, height } = this.#view.frame.bbox;
    return [Math.max(3, Math.min(8, width / 75)), Math.max(3, Math.min(8, height / 55))];
  }

  setRanges([x0, x1, y0, y1]) {
    this.#reframed = true;
    this.#view.invalidate_painters();
    this.#model.x_range.setv({ start: x0, end: x1 });
    this.#model.y_range.setv({ start: y0, end: y1 });
  }

  /** Set the least and most that can be moved to, of x and of y, and what can be seen at least. */
  setBounds(x, y) {
    const open = (end) => (Number.isFinite(end) ? end : null);
    const { x_range, y_range } = this.#model;
    for (const [range, { least, most, narrowest }] of [
      [x_range, x],
      [y_range, y],
    ]) {
      range.setv({ bounds: [open(least), open(most)], min_interval: narrowest });
    }
  }

  setAxis(side, label, { places, words }) {
    const axis = (side === "x" ? this.#model.below : this.#model.left)[0];
    axis.ticker.setv({ ticks: places });
    axis.setv({ axis_label: label, major_label_overrides: words });
  }

  /** Call back with the ends of x and y when the reader has moved or zoomed. */
  onMove(moved) {
    const { x_range, y_range } = this.#model;
    const told = () => {
      if (!this.#quiet) moved([x_range.start, x_range.end, y_range.start, y_range.end]);
    };
    x_range.change.connect(told);
    y_range.change.connect(told);
  }

  /** Call back with the place that was clicked or tapped. */
  onTap(tapped) {
    this.#model.on_event("tap", ({ x, y }) => tapped(x, y));
  }

  /** Call back when the figure has another size. */
  onSize(sized) {
    for (const name of ["inner_width", "inner_height"]) {
      this.#model.properties[name].change.connect(sized);
    }
  }

  /** Take the colours of the page; the border shows the page itself. */
  paintAs({ ink, line, panel }) {
    this.#model.setv({
      background_fill_color: panel,
      outline_line_color: line,
    });
    for (const axis of [this.#model.below[0], this.#model.left[0]]) {
      axis.setv({
        axis_label_text_color: ink,
        major_label_text_color: ink,
        axis_line_color: line,
        major_tick_line_color: line,
      });
    }
  }

  /** Draw with so many pixels to a unit of the screen, whatever the screen has. */
  sharpen(ratio) {
    const { canvas_view } = this.#view;
    for (const layer of [canvas_view.primary, canvas_view.overlays]) {
      Object.defineProperty(layer, "pixel_ratio", { value: ratio });
    }
    canvas_view.resize();
  }

  /** The canvases of the figure, each above the one before. */
  layers() {
    const { primary, overlays } = this.#view.canvas_view;
    return [primary.canvas, overlays.canvas];
  }
}
