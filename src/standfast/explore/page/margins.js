/** Bars of stiffness beside their thresholds, and the table of margins. */
import { shortNumber } from "./content.js";
import { jointRows, marginRows } from "./words.js";

/** Make what shows the margins; the function that is returned puts facts into it. */
export function marginsIn(bars, table) {
  const rows = [0, 1, 2].map(() => barIn(bars));
  const scale = document.createElement("p");
  scale.className = "note";
  bars.after(scale);
  const write = writer();
  return (facts, fedBack, nerves) => {
    const joints = jointRows(facts);
    const edge = edgeOf(joints);
    joints.forEach((joint, i) => {
      showBar(rows[i], joint, edge, write);
    });
    write(scale, `Bars end at ${shortNumber(edge, 3)} N·m/rad; line: threshold, others as given`);
    showTable(table, marginRows(facts, fedBack, nerves), write);
  };
}

/** Writes a text only where it changes. */
export function writer() {
  const known = new WeakMap();
  return (element, text) => {
    if (known.get(element) === text) return;
    known.set(element, text);
    element.textContent = text;
  };
}

function barIn(bars) {
  const item = document.createElement("li");
  item.innerHTML =
    '<span class="joint-name"></span> <span class="joint-words"></span>' +
    '<span class="track" aria-hidden="true"><span class="own"></span><span class="needed"></span></span>';
  bars.append(item);
  const part = (name) => item.querySelector(`.${name}`);
  return {
    item,
    ...{ name: part("joint-name"), words: part("joint-words") },
    ...{ own: part("own"), needed: part("needed") },
  };
}

// a threshold far away would flatten all bars
function edgeOf(joints) {
  const finite = (values) => values.filter((value) => Number.isFinite(value));
  const own = finite(joints.map((joint) => joint.own));
  const every = finite(joints.map((joint) => joint.needed)).concat(own);
  const ordinary = own.some((value) => value > 0) ? own : every;
  return Math.min(1.25 * Math.max(...every, 1), 3 * Math.max(...ordinary, 1));
}

function showBar(row, joint, edge, write) {
  write(row.name, joint.joint[0].toUpperCase() + joint.joint.slice(1));
  write(row.words, joint.words);
  row.item.classList.toggle("too-soft", !joint.holds);
  row.own.style.width = `${100 * Math.min(joint.own / edge, 1)}%`;
  const finite = Number.isFinite(joint.needed);
  row.needed.hidden = !finite;
  row.needed.style.left = `${100 * Math.min((finite ? joint.needed : edge) / edge, 1)}%`;
  row.needed.classList.toggle("beyond", finite && joint.needed > edge);
}

/** Put rows of a name and a value into a table. */
export function showTable(table, rows, write) {
  while (table.rows.length > rows.length) table.deleteRow(-1);
  rows.forEach(([name, value], i) => {
    if (i >= table.rows.length) {
      const row = table.insertRow();
      const head = document.createElement("th");
      head.scope = "row";
      row.append(head, document.createElement("td"));
    }
    table.rows[i].classList.toggle("head", value === "");
    const [head, cell] = table.rows[i].cells;
    write(head, name);
    write(cell, value);
  });
}
