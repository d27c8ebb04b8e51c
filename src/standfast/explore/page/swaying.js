/** The section of sway: sentence, table, and the picture as SVG. */
import { showTable, writer } from "./margins.js";
import { svgElement } from "./person.js";
import { ellipseOf, shownSway, swayWords, WITHIN_ONE } from "./sway.js";
import { roundNumbers } from "./ticks.js";

/** The frame of the picture in its SVG. */
const LEFT = 58;
const TOP = 8;
const WIDE = 248;
const TALL = 208;
const MIDDLE = [LEFT + WIDE / 2, TOP + TALL / 2];
const HALVES = [WIDE / 2, TALL / 2];

/** Make what shows sway; the function that is returned puts what is known of a person into it. */
export function swayIn({ box, sentence, svg, table, seen }) {
  const write = writer();
  let drawn = "";
  return (nerves, answer, served, waiting) => {
    box.hidden = !nerves.noisy;
    if (box.hidden) return;
    const shown = shownSway(nerves, answer, served, waiting, seen);
    write(sentence, shown.sentence);
    showTable(table, shown.rows, write);
    const key = JSON.stringify(shown.picture);
    if (key === drawn) return;
    drawn = key;
    svg.toggleAttribute("hidden", !shown.picture);
    if (!shown.picture) return;
    svg.setAttribute("aria-label", swayWords(shown.picture));
    svg.replaceChildren(...(shown.picture.joints.length === 1 ? bell : ellipse)(shown.picture));
  };
}

function ellipse(picture) {
  const points = ellipseOf(picture);
  const most = [0, 1].map((side) => Math.max(...points.map((point) => Math.abs(point[side]))));
  // a degree is as long across as up
  const scale = 0.9 * Math.min(HALVES[0] / most[0], HALVES[1] / most[1]);
  const outline = points.map(([x, y]) => at(x * scale, y * scale)).join(" ");
  const ends = HALVES.map((side) => side / scale);
  return [
    ...axis("x", `${picture.joints[0]} rotation (°)`, ends[0]),
    ...axis("y", `${picture.joints[1]} rotation (°)`, ends[1]),
    svgElement("polygon", { points: outline, class: "sway" }),
  ];
}

/** Of one joint that turns: how often it stands where, with the middle 95 % shaded. */
function bell({ joints, deviations: [deviation] }) {
  const end = 3.4 * deviation;
  const height = (x) => (2 * Math.exp(-0.5 * (x / deviation) ** 2) - 1) * 0.92 * HALVES[1];
  const curve = (from, to) =>
    Array.from({ length: 81 }, (_, k) => {
      const x = from + (k / 80) * (to - from);
      return at((x / end) * HALVES[0], height(x));
    });
  const edge = WITHIN_ONE * deviation;
  const foot = [edge, -edge].map((x) => at((x / end) * HALVES[0], -HALVES[1]));
  return [
    ...axis("x", `${joints[0]} rotation (°), shaded: 95 %`, end),
    svgElement("polygon", { points: [...curve(-edge, edge), ...foot].join(" "), class: "sway" }),
    svgElement("polyline", { points: curve(-end, end).join(" "), class: "bell" }),
  ];
}

/** Frame, marks and label of an axis that ends at ± a number of degrees. */
function axis(side, label, end) {
  const across = side === "x";
  const half = across ? HALVES[0] : HALVES[1];
  const parts = [];
  if (across) {
    parts.push(svgElement("rect", { x: LEFT, y: TOP, width: WIDE, height: TALL, class: "frame" }));
  }
  for (const value of roundNumbers(-end, end, across ? 6 : 5)) {
    const [x, y] = across
      ? point((value / end) * half, -HALVES[1])
      : point(-HALVES[0], (value / end) * half);
    const mark = across
      ? { x1: x, y1: TOP, x2: x, y2: y }
      : { x1: x, y1: y, x2: LEFT + WIDE, y2: y };
    parts.push(svgElement("line", { ...mark, class: value === 0 ? "middle" : "mark" }));
    const place = across
      ? { x, y: y + 15, "text-anchor": "middle" }
      : { x: x - 5, y: y + 4, "text-anchor": "end" };
    parts.push(text(place, String(value).replace("-", "−")));
  }
  const words = label[0].toUpperCase() + label.slice(1);
  const [x, y] = across ? [MIDDLE[0], TOP + TALL + 33] : [12, MIDDLE[1]];
  const turned = across ? {} : { transform: `rotate(-90 ${x} ${y})` };
  parts.push(text({ x, y, "text-anchor": "middle", ...turned }, words));
  return parts;
}

function text(place, words) {
  const made = svgElement("text", place);
  made.textContent = words;
  return made;
}

/** A place in the SVG, of pixels to the right of the middle and above it. */
function point(right, above) {
  return [MIDDLE[0] + right, MIDDLE[1] - above].map((number) => Number(number.toFixed(2)));
}

function at(right, above) {
  return point(right, above).join(",");
}
