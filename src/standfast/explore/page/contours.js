/** Lines of equal value on a grid, by marching squares; pure. */

/**
 * Return the lines on which a field has a value.
 *
 * The field is given at every `stride`-th of nx × ny points, row by row. A cell with a corner that is
 * no finite number has no line. Lines are found whole: each is one pair of coordinate arrays.
 * @param {Float64Array} field values[iy * nx + ix]
 * @param {Float64Array} xs coordinates of the nx columns
 * @param {Float64Array} ys coordinates of the ny rows
 * @returns {{xs: number[], ys: number[]}[]}
 */
export function contourLines(field, xs, ys, level, stride = 1) {
  const columns = Math.floor((xs.length - 1) / stride) + 1;
  const rows = Math.floor((ys.length - 1) / stride) + 1;
  const segments = segmentsOf(field, xs.length, columns, rows, level, stride);
  return linked(segments).map((edges) => placed(edges, field, xs, ys, columns, level, stride));
}

// An edge of the grid has a number: twice the point at its left or lower end, plus 1 if it goes up.
function segmentsOf(field, width, columns, rows, level, stride) {
  const segments = [];
  for (let row = 0; row + 1 < rows; row++) {
    const low = row * stride * width;
    const high = low + stride * width;
    for (let column = 0; column + 1 < columns; column++) {
      const at = column * stride;
      const a = field[low + at] - level;
      const b = field[low + at + stride] - level;
      const c = field[high + at + stride] - level;
      const d = field[high + at] - level;
      const kind = (a > 0 ? 1 : 0) | (b > 0 ? 2 : 0) | (c > 0 ? 4 : 0) | (d > 0 ? 8 : 0);
      if (kind === 0 || kind === 15 || !Number.isFinite(a + b + c + d)) continue;
      const point = row * columns + column;
      const [bottom, left] = [2 * point, 2 * point + 1];
      const [right, top] = [2 * (point + 1) + 1, 2 * (point + columns)];
      const above = a + b + c + d > 0;
      crossed(segments, kind, above, [bottom, right, top, left]);
    }
  }
  return segments;
}

// Corners a, b, c, d run from the lower left against the clock; sides bottom, right, top, left.
const CROSSINGS = [[], [3, 0], [0, 1], [3, 1], [1, 2], [], [0, 2], [3, 2]];

function crossed(segments, kind, above, sides) {
  if (kind === 5 || kind === 10) {
    // a saddle: its middle says which corners are joined
    const joined = (kind === 5) === above;
    const pairs = joined ? [0, 1, 2, 3] : [3, 0, 1, 2];
    for (const side of pairs) segments.push(sides[side]);
    return;
  }
  const [from, to] = CROSSINGS[kind > 7 ? 15 - kind : kind];
  segments.push(sides[from], sides[to]);
}

/** Join segments that share an edge into lines; a closed one ends where it began. */
function linked(segments) {
  const neighbours = new Map();
  const join = (edge, other) => {
    const known = neighbours.get(edge);
    if (known) known.push(other);
    else neighbours.set(edge, [other]);
  };
  for (let i = 0; i < segments.length; i += 2) {
    join(segments[i], segments[i + 1]);
    join(segments[i + 1], segments[i]);
  }
  const lines = [];
  const walk = (start) => {
    const line = [start];
    let edge = start;
    while (neighbours.get(edge).length > 0) {
      const next = neighbours.get(edge).pop();
      const back = neighbours.get(next);
      back.splice(back.indexOf(edge), 1);
      line.push(next);
      edge = next;
    }
    lines.push(line);
  };
  for (const [edge, others] of neighbours) if (others.length === 1) walk(edge);
  for (const [edge, others] of neighbours) if (others.length > 0) walk(edge);
  return lines;
}

function placed(edges, field, xs, ys, columns, level, stride) {
  const line = { xs: new Array(edges.length), ys: new Array(edges.length) };
  edges.forEach((edge, i) => {
    const point = edge >> 1;
    const column = (point % columns) * stride;
    const row = Math.floor(point / columns) * stride;
    const [over, up] = edge & 1 ? [0, stride] : [stride, 0];
    const first = field[row * xs.length + column];
    const second = field[(row + up) * xs.length + column + over];
    const share = (level - first) / (second - first);
    line.xs[i] = xs[column] + share * (xs[column + over] - xs[column]);
    line.ys[i] = ys[row] + share * (ys[row + up] - ys[row]);
  });
  return line;
}

/**
 * Choose a place for the label of each line: on the line, inside the frame, away from the others.
 * @param {{xs: number[], ys: number[], text: string}[]} lines
 * @param {number[]} frame x0, x1, y0, y1
 * @param {{x: number, y: number}[]} taken places that no label may cover
 */
export function labelPlaces(lines, frame, taken = []) {
  const [x0, x1, y0, y1] = frame;
  const found = [];
  const inFrame = (x, y) => [(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)];
  const busy = taken.map(({ x, y }) => inFrame(x, y));
  const named = new Set();
  for (const line of lines) {
    let best = null;
    const step = Math.max(1, Math.floor(line.xs.length / 40));
    for (let i = 0; i < line.xs.length; i += step) {
      const [u, v] = inFrame(line.xs[i], line.ys[i]);
      const room = Math.min(u - 0.04, 0.96 - u, v - 0.03, 0.97 - v);
      if (!(room > 0)) continue;
      const gap = busy.reduce((least, [p, q]) => Math.min(least, distance(u - p, v - q)), 1);
      if (gap < 0.06) continue;
      const score = Math.min(gap, 0.3) + 0.5 * Math.min(room, 0.2);
      if (!best || score > best.score) best = { score, u, v, x: line.xs[i], y: line.ys[i] };
    }
    if (!best || (named.has(line.text) && line.xs.length < 60)) continue;
    named.add(line.text);
    busy.push([best.u, best.v]);
    found.push({ x: best.x, y: best.y, text: line.text });
  }
  return found;
}

// words are wide: what lies beside them is nearer than what lies above
function distance(across, up) {
  return Math.max(Math.abs(across) * 0.7, Math.abs(up) * 1.4);
}
