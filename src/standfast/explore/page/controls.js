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
 * Make the controls; what is returned shows the values of a state in them.
 * @param {(name: string, value: number|string) => object} changed gives the values that are then
 * @param {(sentence: string) => void} refused
 */
export function controlsIn(place, content, changed, refused) {
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
    for (const row of rows) shown.push({ row, show: controlIn(fields, row, changed, refused) });
  }
  const known = new Map();
  return (values) => {
    for (const { row, show } of shown) {
      if (Object.is(known.get(row), values[row.name])) continue;
      known.set(row, values[row.name]);
      show(values);
    }
  };
}

function controlIn(fields, row, changed, refused) {
  const box = document.createElement("div");
  box.className = "control";
  fields.append(box);
  if (row.kind === "fixed") return fixedIn(box, row);
  if (!row.numeric) return choiceIn(box, row, changed);
  return sliderIn(box, row, changed, refused);
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

function sliderIn(box, row, changed, refused) {
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
  box.append(labelFor(slider, row), slider, field, unit);
  let last = Number.isFinite(row.start) ? row.start : (row.from + row.to) / 2;
  const rigid = row.or_rigid && !stops ? rigidIn(box, row, () => last, changed) : null;
  slider.addEventListener("input", () => {
    changed(row.name, stops ? stops[Number(slider.value)] : Number(slider.value));
  });
  field.addEventListener("change", () => {
    const value = checkedValue(row, field.value);
    if (value === undefined) {
      refused(`${capital(row.words)} cannot be ${field.value || "empty"}: ${allowedWords(row)}.`);
      field.setAttribute("aria-invalid", "true");
      return;
    }
    // also where the value is what it was, which changes nothing else
    show(changed(row.name, value));
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
