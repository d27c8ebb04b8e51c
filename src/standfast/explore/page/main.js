/** The page: its parts are made, and joined. */
import { askWith } from "./asking.js";
import { Cells, embeddedValues } from "./cells.js";
import { axesOf, contentOf } from "./content.js";
import { controlsIn } from "./controls.js";
import { csvOf, fileName, personJson, save } from "./downloads.js";
import { Explorer } from "./explorer.js";
import { bodyAt, modesAt, oneJoint, slotCount, slots, springs } from "./formulas.js";
import { connectMap } from "./hand.js";
import { StandingMap } from "./map.js";
import { marginsIn } from "./margins.js";
import { PaperMap } from "./paper.js";
import { MovingPerson } from "./person.js";
import { Planes } from "./planes.js";
import { Plot } from "./plot.js";
import { RootPlane } from "./roots.js";
import { hashOf, startState, stateOf } from "./state.js";
import { calledOf, takenFrom } from "./subjects.js";
import { swayIn } from "./swaying.js";

const formulas = { bodyAt, modesAt, oneJoint, slotCount, slots, springs };
const byId = (id) => document.getElementById(id);
const content = contentOf(byId("content").textContent);

function tell(sentence) {
  const status = byId("status");
  if (status.textContent !== sentence) status.textContent = sentence;
}

let seen = null;

/** The colours and the font of the page, as it is seen now. */
function look() {
  seen ??= lookNow();
  return seen;
}

function lookNow() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const font = "system-ui, sans-serif";
  return {
    ground: colour("card"),
    ink: colour("ink"),
    line: colour("line"),
    panel: colour("panel"),
    font,
  };
}

function optionsIn(select, rows, label) {
  for (const row of rows) select.add(new Option(label(row), row.name));
}

function choices(explorer) {
  const { x, y, quantity, subject } = elements;
  for (const select of [x, y]) optionsIn(select, axesOf(content), (row) => row.words);
  optionsIn(quantity, content.quantities, (row) => row.words);
  for (const option of quantity.options) option.dataset.words = option.textContent;
  const chosen = (key, other) => () => {
    const { state } = explorer;
    const value = elements[key].value;
    const swap = other && value === state[other] ? { [other]: state[key] } : {};
    explorer.change({ [key]: value, ...swap, ...(other ? { window: null } : {}) });
    showChoices(explorer.state);
  };
  x.addEventListener("change", chosen("x", "y"));
  y.addEventListener("change", chosen("y", "x"));
  quantity.addEventListener("change", chosen("quantity"));
  const { subjects } = content;
  subject.closest("label").hidden = subjects.length === 0;
  subjects.forEach((_, i) => {
    subject.add(new Option(calledOf(subjects, i), String(i)));
  });
  subject.addEventListener("change", () => {
    const one = subjects[Number(subject.value)];
    if (!one) return;
    const { values } = takenFrom(content, one);
    explorer.change({ values: { ...explorer.state.values, ...values } });
  });
}

function showChoices(state) {
  for (const key of ["x", "y", "quantity"]) elements[key].value = state[key];
}

function buttons(explorer, map, controls, paper) {
  const on = (id, act) => byId(id).addEventListener("click", act);
  on("reset", () => {
    explorer.change(startState(content));
    controls.anew(explorer.state.values);
    showChoices(explorer.state);
    tell("Everything is as it was at the start.");
  });
  on("link", async () => {
    keepAddress(explorer.state);
    try {
      await navigator.clipboard.writeText(location.href);
      const lasts = content.served
        ? " It holds as long as the program runs, and lets in whoever has it."
        : "";
      tell(`The link to this view is copied.${lasts}`);
    } catch {
      tell(`The link to this view: ${location.href}`);
    }
  });
  on("figure", async () => {
    const { drawn } = map;
    const picture = await paper.picture(content, drawn);
    save(fileName(content, drawn.quantity.words, "png"), picture, "image/png");
  });
  on("numbers", () => {
    const { sample, state, quantity } = map.drawn;
    if (!sample.shown) tell("The map has no numbers now.");
    else {
      const name = fileName(content, quantity.words, "csv");
      save(name, csvOf(content, state, sample.shown), "text/csv");
    }
  });
  on("person", () => {
    const { facts, fedBack } = explorer.found;
    const text = personJson(content, explorer.state, facts, fedBack);
    save(fileName(content, "person", "json"), text, "application/json");
  });
}

function keepAddress(state) {
  const hash = hashOf(content, state);
  history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
}

/** What the page leaves out stands at its top. */
function showNotes() {
  for (const note of content.notes) {
    const line = document.createElement("p");
    line.textContent = note;
    byId("notes").append(line);
  }
}

function playerOf(moving) {
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const show = (playing) => {
    moving.play(playing);
    byId("play").textContent = playing ? "Pause" : "Play";
  };
  byId("play").addEventListener("click", () => show(!moving.playing));
  byId("speed").addEventListener("change", (event) => {
    moving.speed = Number(event.target.value);
  });
  byId("amplitude").addEventListener("input", (event) => {
    moving.amplitude = Number(event.target.value);
    event.target.setAttribute("aria-valuetext", `${Math.round(100 * moving.amplitude)} %`);
    moving.draw();
  });
  still.addEventListener("change", () => show(!still.matches));
  show(!still.matches);
}

function addressIn(explorer, controls) {
  const { state, ignored, moved } = stateOf(content, location.hash);
  explorer.change(state);
  controls.anew(state.values);
  showChoices(state);
  const sentences = [
    ignored.length ? `Of the address this was not understood: ${ignored.join(", ")}.` : "",
    moved.length ? `The atlas has other values than the address: ${moved.join("; ")}.` : "",
  ];
  if (sentences.some(Boolean)) tell(sentences.filter(Boolean).join(" "));
}

const elements = Object.fromEntries(
  [
    ...["map", "bar", "computing", "word", "marks", "verdict", "said", "x", "y", "quantity"],
    ...["subject", "outside", "roots", "unmoved", "figure", "numbers"],
  ].map((id) => [id, byId(id)]),
);

async function open() {
  showNotes();
  const figures = JSON.parse(byId("figures").textContent);
  const [plot, rootPlot] = await Promise.all([
    Plot.of(figures.map, elements.map),
    Plot.of(figures.roots, elements.roots),
  ]);
  const ask = content.served ? askWith(content.token) : null;
  const whole = content.embedded ? await embeddedValues(content) : null;
  let explorer = null;
  const sources = { ask, whole, arrived: () => explorer.draw() };
  const cells = content.atlas ? new Cells(content, sources) : null;
  const planes = new Planes(content, formulas, { ...sources, cells });
  const map = new StandingMap(plot, content.constants);
  const moving = new MovingPerson(byId("figure-of-person"));
  const roots = new RootPlane(rootPlot);
  const changed = (name, value) => {
    explorer.change({ values: { ...explorer.state.values, [name]: value } });
    return explorer.state.values;
  };
  const controls = controlsIn(byId("controls"), content, changed);
  const margins = marginsIn(byId("bars"), byId("margins"));
  const sway = swayIn({
    box: byId("sway-box"),
    sentence: byId("sway-words"),
    svg: byId("sway-picture"),
    table: byId("sway"),
    seen: content.constants.seen,
  });
  const parts = { map, moving, roots, margins, sway, controls, planes, elements, look };
  parts.rested = () => keepAddress(explorer.state);
  explorer = new Explorer(content, formulas, parts, startState(content), ask, tell);
  choices(explorer);
  connectMap(explorer, plot, elements.map, {
    nearer: byId("nearer"),
    farther: byId("farther"),
    whole: byId("whole"),
  });
  buttons(explorer, map, controls, new PaperMap(figures.map));
  const recolour = () => {
    seen = null;
    for (const each of [plot, rootPlot]) each.paintAs(look());
    explorer.draw();
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  plot.onSize(() => {
    map.resized();
    elements.bar.dataset.width = String(globalThis.innerWidth);
    explorer.draw();
  });
  globalThis.addEventListener("hashchange", () => addressIn(explorer, controls));
  // for measurements
  globalThis.standfastTimes = explorer.times;
  globalThis.standfastDrawn = explorer.drawn;
  recolour();
  addressIn(explorer, controls);
  playerOf(moving);
  // what sticks below the verdict begins where it ends
  new ResizeObserver(([{ target }]) => {
    document.documentElement.style.setProperty("--verdict-height", `${target.offsetHeight}px`);
  }).observe(byId("verdict-box"));
  byId("leaves").textContent = content.served
    ? "It asks the program on this machine, and nobody else."
    : "Nothing leaves this page.";
  document.documentElement.dataset.ready = "yes";
}

open().catch((error) => {
  tell(`The page could not be shown: ${error.message}`);
  throw error;
});
