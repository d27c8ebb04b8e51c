/** One loop from what the reader does to what is seen: all that changed is drawn in one frame. */
import { factsFrom, Newest } from "./asking.js";
import { showScale } from "./bar.js";
import { encoded } from "./content.js";
import { lengthsOf, movementOf, nervesOf, oneJointFacts, rootsOf, springFacts } from "./facts.js";
import { axisOf, spreadOver, windowOf } from "./frame.js";
import { writer } from "./margins.js";
import { rootWords } from "./roots.js";
import { fillPerson } from "./state.js";
import { marksWords, takenFrom, takenWords } from "./subjects.js";
import { mapWords, movementWords, verdictWords } from "./words.js";

/** Milliseconds after the last change until the picture is made in full. */
const REST = 250;
const KEPT_TIMES = 1000;

/** Offer in a list the quantities that can be shown, and say at the others what they need. */
function offer(select, state, planes) {
  for (const option of select.options) {
    const lacks = planes.lacking(state, option.value);
    option.disabled = lacks !== null && option.value !== state.quantity;
    const words = lacks ? `${option.dataset.words} – needs ${lacks.needs}` : option.dataset.words;
    if (option.textContent !== words) option.textContent = words;
    option.title = lacks?.sentence ?? "";
  }
}

/** What the page shows of a state, and when. */
export class Explorer {
  #content;
  #formulas;
  #parts;
  #person;
  #fedBack;
  #key = "";
  #tell;
  #waiting = false;
  #requested = 0;
  #early = null;
  #timer = 0;
  #inputAt = 0;
  #changedAt = Number.NEGATIVE_INFINITY;
  #said = "";
  #rootWords = "";
  #pictures = 0;
  #write = writer();
  /** The person as last shown. */
  found = { facts: null, fedBack: null };
  /** From an input to the painted picture, ms. */
  times = [];
  /** Points along a side of the picture as last drawn; 0 without values. */
  drawn = { side: 0 };
  state;

  /** @param {object} parts map, moving, roots, margins, sway, controls, planes, elements, look, rested */
  constructor(content, formulas, parts, state, ask, tell) {
    this.#content = content;
    this.#formulas = formulas;
    this.#parts = parts;
    this.#person = new Float64Array(formulas.slotCount);
    this.#tell = tell;
    this.state = state;
    const answer = async (question, signal) => factsFrom(await ask("/person", question, signal));
    this.#fedBack = ask && new Newest(answer, () => this.draw(), tell);
  }

  /** Take a change of the state, and draw it soon; `at` is when the reader made it. */
  change(changes, at = performance.now()) {
    Object.assign(this.state, changes);
    this.#tell(""); // what was said of the state before
    this.#inputAt ||= at;
    this.#changedAt = performance.now();
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#rest(), REST);
    const first = this.#requested === 0;
    this.draw();
    // what the map shows is found while the browser waits for its frame, once: if more changes come
    // before it, in the frame
    if (first)
      queueMicrotask(() => {
        this.#early = this.#sampled(false);
      });
  }

  /** Draw the state in the next frame. */
  draw() {
    this.#early = null;
    if (this.#requested === 0) this.#requested = requestAnimationFrame(() => this.#frame());
  }

  /** The axes of the map and the window that is seen. */
  view() {
    const { state } = this;
    const [x, y] = [axisOf(this.#content, state.x), axisOf(this.#content, state.y)];
    return { x, y, window: windowOf(state, x, y) };
  }

  /** The view of the state, and what its map shows. */
  #sampled(resting) {
    const { x, y, window } = this.view();
    const spread = (low, high, side, axis) => spreadOver(axis === "x" ? x : y, low, high, side);
    return { x, y, window, sample: this.#parts.planes.sample(this.state, window, spread, resting) };
  }

  #frame() {
    this.#requested = 0;
    const began = this.#inputAt;
    this.#inputAt = 0;
    const { state } = this;
    const { map, controls, elements } = this.#parts;
    const resting = performance.now() - this.#changedAt >= REST - 10;
    const { x, y, window, sample } = (!resting && this.#early) || this.#sampled(resting);
    this.#early = null;
    const quantity = this.#content.quantity[state.quantity];
    const subjects = this.#content.subjects ?? [];
    // what is taken home is written from the state of its values, not from a later one
    const of = sample.of ?? { ...state, values: { ...state.values } };
    const wanted = { sample, x, y, window, quantity, point: state.values, subjects, state: of };
    const drawn = map.show(wanted);
    this.drawn.side = drawn.sample.shown?.xs.length ?? 0;
    showScale(elements.bar, drawn.seen.quantity, drawn.scale, this.#parts.look());
    elements.computing.hidden = !sample.pending;
    for (const button of [elements.figure, elements.numbers]) {
      button.disabled = sample.pending || sample.coarse;
    }
    this.#write(elements.word, sample.word);
    controls.show(state.values);
    // while a slider moves the map comes first, and the person once it is painted
    if (resting) this.#showPerson(resting);
    else setTimeout(() => this.#showPerson(false));
    if (sample.coarse && resting && !sample.pending) this.draw();
    if (resting) {
      this.#write(elements.marks, this.#marksWords({ x, y, window }));
      offer(elements.quantity, state, planes);
      this.#say(sample.pending);
    }
    if (began) this.#measure(began);
  }

  #showPerson(resting) {
    const { state } = this;
    const { moving, roots, margins, elements } = this.#parts;
    const person = fillPerson(this.#content, this.#formulas.slots, state.values, this.#person);
    const nerves = nervesOf(state);
    const facts = springFacts(this.#formulas, person);
    const fedBack = this.#fedBackOf(person, nerves);
    this.found = { facts, fedBack };
    const rigid = facts.own.map((own) => own === Number.POSITIVE_INFINITY);
    const body = this.#formulas.bodyAt(person);
    const movement = movementOf(facts, fedBack, nerves);
    const { ankle_height: ankle } = this.#content.constants;
    moving.show(lengthsOf(body, state.values.height, ankle), rigid, movement);
    const inPlane = rootsOf(facts, fedBack, nerves);
    // of pictures in quick succession each third has new roots, which take long to draw
    this.#pictures += 1;
    if (resting || this.#pictures % 3 === 0) roots.show(inPlane);
    this.#write(elements.outside, roots.beyond(inPlane));
    margins(facts, fedBack, nerves);
    this.#showSway(nerves);
    const verdict = verdictWords(facts, fedBack, nerves);
    this.#write(elements.verdict, verdict);
    const stands = fedBack && nerves.gained ? fedBack.stands : facts.stands;
    elements.verdict.classList.toggle("falls", stands === false);
    elements.verdict.classList.toggle("open", stands === null);
    elements.verdict.classList.toggle("stale", fedBack?.stale === true);
    // a verdict that is still to come is not announced as if it were there
    this.#said = this.#waiting ? "" : verdict;
    const unknown = movement ? "" : movementWords(facts, fedBack, this.#fedBack, this.#waiting);
    this.#write(elements.unmoved, unknown);
    this.#rootWords = inPlane.length ? rootWords(inPlane) : unknown;
  }

  /** What of the subjects, and of the person, is shown otherwise than they are, or not. */
  #marksWords(view) {
    const { values } = this.state;
    const { subject } = this.#parts.elements;
    const taken = subject.value && takenFrom(this.#content, this.#content.subjects[subject.value]);
    if (taken && Object.entries(taken.values).some(([name, value]) => values[name] !== value)) {
      subject.value = ""; // the person has been moved since
    }
    const words = subject.value ? takenWords(this.#content, Number(subject.value)) : "";
    return [words, marksWords(this.#content, view, values)].filter(Boolean).join(" ");
  }

  #showSway(nerves) {
    const asked = this.#fedBack;
    const served = asked !== null;
    this.#parts.sway(nerves, asked?.answer, served, served && asked.key !== this.#key);
  }

  #fedBackOf(person, nerves) {
    this.#waiting = false;
    if (!nerves.gained && !nerves.damped) return null;
    const one = oneJointFacts(this.#formulas, person, nerves);
    if (!this.#fedBack) return one;
    const parameters = Object.fromEntries(
      Object.entries(this.state.values).map(([name, value]) => [name, encoded(value)]),
    );
    this.#key = JSON.stringify(parameters);
    this.#fedBack.want(this.#key, { parameters });
    const { answer } = this.#fedBack;
    if (this.#fedBack.key === this.#key) return answer;
    if (this.#fedBack.refusal(this.#key) !== undefined) return one;
    this.#waiting = true;
    return one ?? (answer && { ...answer, stale: true });
  }

  #rest() {
    this.draw();
    this.#parts.rested();
  }

  /** Tell those who listen, once the reader rests. */
  #say(pending) {
    const { elements } = this.#parts;
    this.#write(elements.said, this.#said);
    elements.map.setAttribute(
      "aria-label",
      mapWords(this.#content, this.state, this.#said, pending),
    );
    elements.roots.setAttribute("aria-label", this.#rootWords);
  }

  #measure(began) {
    // a message is taken up after the frame has been painted
    const channel = new MessageChannel();
    channel.port1.onmessage = () => {
      const end = performance.now();
      performance.measure("input→painted", { start: began, end });
      this.times.push(end - began);
      if (this.times.length > KEPT_TIMES) this.times.shift();
      channel.port1.close();
    };
    channel.port2.postMessage(0);
  }
}
