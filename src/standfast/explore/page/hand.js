/** What the reader does on the map: move the point, drag, zoom. */
import { windowOf } from "./frame.js";

const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };

/**
 * Let the reader's hand, wheel and keys change the state through the map.
 * @param {object} plot the figure of Bokeh
 * @param {HTMLElement} element what has the focus
 */
export function connectMap(explorer, plot, element, buttons) {
  const change = (changes) => explorer.change(changes);
  const pick = (across, up) => {
    const { x, y } = explorer.view();
    const values = { ...explorer.state.values };
    values[x.row.name] = onAxis(x, x.value(across));
    values[y.row.name] = onAxis(y, y.value(up));
    change({ values });
  };
  plot.onTap(pick);
  const see = (window) => {
    const { x, y } = explorer.view();
    change({ window: window && windowOf({ window }, x, y) });
  };
  plot.onMove(([x0, x1, y0, y1]) => {
    const { x, y } = explorer.view();
    see([x.value(x0), x.value(x1), y.value(y0), y.value(y1)]);
  });
  const zoom = (factor) => see(factor && zoomed(explorer.view(), factor));
  buttons.nearer.addEventListener("click", () => zoom(0.5));
  buttons.farther.addEventListener("click", () => zoom(2));
  buttons.whole.addEventListener("click", () => zoom(null));
  element.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const step = KEYS[event.key];
    if (step) movePoint(explorer, step, event.shiftKey ? 10 : 1);
    else if (event.key === "+" || event.key === "=") zoom(0.5);
    else if (event.key === "-") zoom(2);
    else if (event.key === "0") zoom(null);
    else return;
    event.preventDefault();
  });
}

function movePoint(explorer, [across, up], times) {
  const view = explorer.view();
  const values = { ...explorer.state.values };
  for (const [axis, way, ends] of [
    [view.x, across, view.window.slice(0, 2)],
    [view.y, up, view.window.slice(2)],
  ]) {
    if (way) values[axis.row.name] = stepped(axis, values[axis.row.name], way * times, ends);
  }
  explorer.change({ values });
}

function stepped(axis, value, steps, [low, high]) {
  if (!Number.isFinite(value)) return onAxis(axis, steps > 0 ? low : high);
  if (axis.stops) {
    const at = axis.stops.indexOf(onAxis(axis, value)) + steps;
    return axis.stops[Math.max(0, Math.min(axis.stops.length - 1, at))];
  }
  return onAxis(axis, value + (steps * (high - low)) / 200);
}

/** A value as an axis can have it: the nearest stop, or a number of few digits in its range. */
function onAxis(axis, value) {
  if (axis.stops) {
    const away = (stop) => Math.abs(axis.place(stop) - axis.place(value));
    return axis.stops.reduce((best, stop) => (away(stop) < away(best) ? stop : best));
  }
  const inside = Math.max(axis.row.lowest, Math.min(axis.row.highest, value));
  return Number(inside.toPrecision(5));
}

function zoomed({ x, y, window }, factor) {
  const side = (axis, low, high) => {
    const [from, to] = [axis.place(low), axis.place(high)];
    const middle = (from + to) / 2;
    const half = ((to - from) / 2) * factor;
    const [least, most] = axis.beyond.map(axis.place);
    const ends = [Math.max(least, middle - half), Math.min(most, middle + half)];
    return ends.map(axis.value);
  };
  return [...side(x, window[0], window[1]), ...side(y, window[2], window[3])];
}
