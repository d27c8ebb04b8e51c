/** Sliders, fields and choices for all parameters: native HTML, one group a kind. */
import { shortNumber, valueWords } from "./content.js";
import { allowedWords, checkedValue, nearestStop } from "./state.js";

const SINGLE = /^(ankle|knee|hip)_stiffness$/;
const CROSS = /^(ankle|knee|hip)_(ankle|knee|hip)_.*_gain$/;

/** The group of the page to which a parameter belongs. */
export function groupOf(row) {
  if (SINGLE.test(row.name)) return "Stiffness";
  if (row.section === "stiffness") return "Coupling";
  if (row.section.startsWith("damping")) return "Damping";
  if (row.section.startsWith("feedback")) return CROSS.test(row.name) ? "Cross gains" : "Feedback";
  if (row.section === "noise") return "Noise of the torques";
  return "Body";
}

const GROUPS = [
  ...["Stiffness", "Body", "Damping", "Feedback", "Cross gains"],
  ...["Noise of the torques", "Coupling"],
];
const OPEN = new Set(["Stiffness", "Body"]);

/**
 * Make the controls.
 * @param {(name: string, value: number|string) => object} changed gives the values that are then
 * @returns {{show: (values: object) => void, anew: (values: object) => void}} show what has changed
 *   of the values of a state; `anew`: all, also where a refused number is written
 */
export function controlsIn(place, content, changed) {
  const shown = [];
  for (const group of GROUPS) {
    const rows = content.parameters.filter((row) => groupOf(row) === group);
    if (rows.length === 0) continue;
    const varies = rows.some((row) => row.kind !== "fixed");
    const box = document.createElement("details");
    box.open = OPEN.has(group) || (content.atlas && varies);
    const summary = document.createElement("summary");
    summary.textContent = group;
    const fields = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.className = "hidden";
    legend.textContent = group;
    fields.append(legend);
    box.append(summary, fields);
    place.append(box);
    for (const row of rows) shown.push({ row, show: controlIn(fields, row, changed) });
  }
  const known = new Map();
  const show = (values) => {
    for (const { row, show: showOne } of shown) {
      if (Object.is(known.get(row), values[row.name])) continue;
      known.set(row, values[row.name]);
      showOne(values);
    }
  };
  const anew = (values) => {
    known.clear();
    show(values);
  };
  return { show, anew };
}

function controlIn(fields, row, changed) {
  const box = document.createElement("div");
  box.className = "control";
  fields.append(box);
  if (row.kind === "fixed") return fixedIn(box, row);
  if (!row.numeric) return choiceIn(box, row, changed);
  return sliderIn(box, row, changed);
}

function fixedIn(box, row) {
  box.classList.add("fixed");
  box.textContent = `${capital(row.words)}: ${valueWords(row, row.start)} (fixed)`;
  return () => {};
}

function choiceIn(box, row, changed) {
  const select = document.createElement("select");
  select.id = `p-${row.name}`;
  for (const word of row.kind === "stops" ? row.stops : row.choices) {
    select.add(new Option(word, word));
  }
  select.addEventListener("change", () => changed(row.name, select.value));
  box.append(labelFor(select, row), select);
  return (values) => {
    select.value = values[row.name];
  };
}

function sliderIn(box, row, changed) {
  const stops = row.kind === "stops" ? row.stops : null;
  const slider = input("range", `p-${row.name}`);
  const field = input(stops ? "text" : "number", `n-${row.name}`);
  field.setAttribute(
    "aria-label",
    `${row.words}, number${row.unit === "1" ? "" : ` in ${row.unit}`}`,
  );
  if (stops) Object.assign(slider, { min: 0, max: stops.length - 1, step: 1 });
  else {
    Object.assign(slider, { min: row.from, max: row.to, step: row.step || "any" });
    Object.assign(field, { min: row.lowest, max: row.highest, step: "any" });
  }
  slider.title = row.meaning;
  const unit = document.createElement("span");
  unit.className = "unit";
  unit.textContent = row.unit === "1" ? "" : row.unit;
  const refusal = refusalOf(field, row);
  box.append(labelFor(slider, row), slider, field, unit, refusal);
  let last = Number.isFinite(row.start) ? row.start : (row.from + row.to) / 2;
  const rigid = row.or_rigid && !stops ? rigidIn(box, row, () => last, changed) : null;
  slider.addEventListener("input", () => {
    changed(row.name, stops ? stops[Number(slider.value)] : Number(slider.value));
  });
  field.addEventListener("change", () => {
    const value = checkedValue(row, field.value);
    if (value === undefined) {
      const typed = field.validity.badInput ? "what is no number" : field.value || "empty";
      refusal.textContent = `Cannot be ${typed}: ${allowedWords(row)}.`;
      field.setAttribute("aria-invalid", "true");
      return;
    }
    const typed = field.value;
    // also where the value is what it was, which changes nothing else
    show(changed(row.name, value));
    if (Number.isFinite(value) && value !== Number(typed)) {
      refusal.textContent = `${typed} is not a value of the atlas; this is the nearest.`;
    }
  });
  const show = (values) => {
    const value = values[row.name];
    const infinite = value === Number.POSITIVE_INFINITY;
    if (!infinite) last = value;
    const at = stops
      ? stops.indexOf(stops.includes(value) ? value : nearestStop(stops, value))
      : value;
    if (!infinite || stops) slider.value = at;
    field.removeAttribute("aria-invalid");
    refusal.textContent = "";
    field.value = stops ? shortNumber(value) : infinite ? "" : Number(value.toPrecision(8));
    slider.setAttribute("aria-valuetext", valueWords(row, value));
    if (rigid) {
      rigid.checked = infinite;
      slider.disabled = infinite;
      field.disabled = infinite;
    }
  };
  return show;
}

/** Where it is said, below a field and aloud, why a number is refused or another. */
function refusalOf(field, row) {
  const refusal = document.createElement("p");
  Object.assign(refusal, { id: `e-${row.name}`, className: "refusal" });
  refusal.setAttribute("role", "alert");
  field.setAttribute("aria-describedby", refusal.id);
  return refusal;
}

function rigidIn(box, row, last, changed) {
  const label = document.createElement("label");
  label.className = "rigid";
  const check = input("checkbox", `r-${row.name}`);
  check.setAttribute("aria-label", `${row.words}: rigid`);
  label.append(check, " rigid");
  box.append(label);
  check.addEventListener("change", () => {
    changed(row.name, check.checked ? Number.POSITIVE_INFINITY : last());
  });
  return check;
}

function input(type, id) {
  const made = document.createElement("input");
  Object.assign(made, { type, id });
  return made;
}

function labelFor(control, row) {
  const label = document.createElement("label");
  label.htmlFor = control.id;
  label.textContent = capital(row.words);
  label.title = row.meaning;
  return label;
}

function capital(words) {
  return words[0].toUpperCase() + words.slice(1);
}
