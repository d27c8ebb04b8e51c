/** The stick figure: how the person moves in the least stable movement. */

const TURN = (10 * Math.PI) / 180; // of what turns or leans most, while it sways
const FALLEN = (25 * Math.PI) / 180;
const LEAN = (1.2 * Math.PI) / 180; // with which a fall begins
const LYING = 0.6; // s on the ground before it starts again

const NAMESPACE = "http://www.w3.org/2000/svg";

/** The moving person in an SVG. */
export class MovingPerson {
  #svg;
  #figure;
  #ghosts;
  #lengths = [1, 1, 1];
  #rigid = [false, false, false];
  #movement = null;
  #time = 0;
  #last = 0;
  #request = 0;
  playing = false;
  speed = 1;
  amplitude = 1;

  constructor(svg) {
    this.#svg = svg;
    const ground = svgElement("g", { class: "ground" });
    ground.append(
      svgElement("line", { x1: -0.62, y1: 0.075, x2: 0.62, y2: 0.075, class: "floor" }),
      svgElement("line", { x1: 0, y1: 0.07, x2: 0, y2: -1.9, class: "plumb" }),
      svgElement("path", {
        d: "M -0.06 0.07 L 0.19 0.07 L 0.04 -0.03 L -0.04 -0.03 Z",
        class: "foot",
      }),
    );
    this.#ghosts = [figureOf("ghost"), figureOf("ghost")];
    this.#figure = figureOf("figure");
    svg.append(ground, ...this.#ghosts.map((ghost) => ghost.group), this.#figure.group);
  }

  /** Show a person: lengths of segments (m), which joints are rigid, and how it moves. */
  show(lengths, rigid, movement) {
    const same = JSON.stringify([lengths, rigid]) === JSON.stringify([this.#lengths, this.#rigid]);
    if (!same) this.#measure(lengths, rigid);
    this.#movement = movement;
    this.#svg.classList.toggle("falls", (movement?.root[0] ?? 0) > 0);
    this.draw();
  }

  #measure(lengths, rigid) {
    [this.#lengths, this.#rigid] = [lengths, rigid];
    const top = 1.06 * (lengths[0] + lengths[1] + lengths[2]);
    const half = 0.48 * top;
    this.#svg.setAttribute("viewBox", `${-half} ${-top} ${2 * half} ${top + 0.1}`);
    for (const { joints } of [this.#figure, ...this.#ghosts]) {
      joints.forEach((joint, i) => {
        joint.classList.toggle("rigid", rigid[i]);
      });
    }
  }

  /** Start or stop the movement. */
  play(playing) {
    this.playing = playing;
    cancelAnimationFrame(this.#request);
    this.#last = 0;
    if (playing) this.#request = requestAnimationFrame((now) => this.#step(now));
  }

  #step(now) {
    if (this.#last) this.#time += Math.min((now - this.#last) / 1000, 0.1) * this.speed;
    this.#last = now;
    this.draw();
    this.#request = requestAnimationFrame((next) => this.#step(next));
  }

  /** Draw the present moment, and both extremes behind it. */
  draw() {
    const movement = this.#movement ?? { root: [0, 0], turns: [0, 0, 0].map(() => [0, 0]) };
    const [rate, omega] = movement.root;
    const falls = rate > 0;
    const extreme = falls ? FALLEN : TURN * this.amplitude;
    const turned = (size, phase) =>
      movement.turns.map(([re, im]) => size * (re * Math.cos(phase) - im * Math.sin(phase)));
    const still = this.#movement === null ? 0 : 1;
    this.#ghosts.forEach((ghost, i) => {
      this.#place(ghost, turned(still * (i ? -extreme : extreme), 0));
    });
    let [size, phase] = [extreme, omega * this.#time];
    if (falls) {
      const start = LEAN * this.amplitude;
      const duration = Math.log(FALLEN / start) / rate;
      const passed = this.#time % (duration + LYING * this.speed);
      size = Math.min(start * Math.exp(rate * passed), FALLEN);
      phase = omega * Math.min(passed, duration);
    } else if (!this.playing && this.#time === 0) {
      size = 0;
    } else if (omega === 0) {
      // a lean that creeps back upright
      const duration = Math.log(20) / Math.max(-rate, 1e-3);
      size = extreme * Math.exp(rate * (this.#time % duration));
    }
    this.#place(this.#figure, turned(still * size, phase));
  }

  #place({ limbs, joints, head }, turns) {
    let [x, y, angle] = [0, -0.02, 0];
    this.#lengths.forEach((length, i) => {
      angle += turns[i];
      const last = i === 2;
      const reach = last ? 0.72 * length : length;
      const [toX, toY] = [x + reach * Math.sin(angle), y - reach * Math.cos(angle)];
      set(limbs[i], { x1: x, y1: y, x2: toX, y2: toY });
      set(joints[i], { cx: x, cy: y });
      if (last) {
        const middle = 0.87 * length;
        set(head, { cx: x + middle * Math.sin(angle), cy: y - middle * Math.cos(angle) });
        head.setAttribute("r", (0.13 * length).toFixed(4));
      }
      [x, y] = [toX, toY];
    });
  }
}

/** An element of SVG with attributes. */
export function svgElement(name, attributes) {
  const made = document.createElementNS(NAMESPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

function set(shape, attributes) {
  for (const [key, value] of Object.entries(attributes)) shape.setAttribute(key, value.toFixed(4));
}

function figureOf(name) {
  const group = svgElement("g", { class: name });
  const limbs = [0, 1, 2].map(() => svgElement("line", { class: "limb" }));
  const joints = [0, 1, 2].map(() => svgElement("circle", { r: 0.033, class: "joint" }));
  const head = svgElement("circle", { r: 0.1, class: "head" });
  group.append(...limbs, head, ...joints);
  return { group, limbs, joints, head };
}
