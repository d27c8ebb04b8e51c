/** Questions to the program that serves the page. */
import { decoded } from "./content.js";

/**
 * Return a function that asks the program and gives its answer: (path, body) → Response.
 * What the program refuses is thrown as its own sentence; what a newer question of this page ended
 * is as if it had been aborted. Other pages of the same program have a name of their own.
 */
export function askWith(token) {
  const page = crypto.getRandomValues(new Uint32Array(4)).join("-");
  return async (path, body, signal) => {
    let response;
    try {
      response = await fetch(path, {
        method: "POST",
        headers: {
          "Content-Type": "application/json",
          "X-Standfast-Token": token,
          "X-Standfast-Page": page,
        },
        body: JSON.stringify(body),
        signal,
      });
    } catch (error) {
      if (error.name === "AbortError") throw error;
      throw new Error("The program does not answer; is it still running?");
    }
    if (response.status === 409) throw new DOMException(await response.text(), "AbortError");
    if (!response.ok) throw new Error(await response.text());
    return response;
  };
}

/**
 * Keep the newest answer to a question that changes quickly: one is under way at a time, and of
 * those that come meanwhile only the last is asked. One that takes long gives way to a newer one.
 */
export class Newest {
  #ask;
  #arrived;
  #failed;
  #running = null;
  #next = null;
  #refused = new Map();
  #place = null;
  key = null;
  answer = null;

  /**
   * @param {(question: object, signal: AbortSignal) => Promise<object>} ask
   * @param {() => void} arrived called when there is a new answer, or none will come
   * @param {(sentence: string) => void} failed
   */
  constructor(ask, arrived, failed = () => {}) {
    this.#ask = ask;
    this.#arrived = arrived;
    this.#failed = failed;
  }

  /** The sentence with which the question of a key was refused, if it was. */
  refusal(key) {
    return this.#refused.get(key);
  }

  /**
   * Want the answer to a question with a key; what is known so far is `answer`, of `key`. What was
   * refused is asked again only once a question of another place has been wanted.
   */
  want(key, question, { long = false, place = key } = {}) {
    if (place !== this.#place) {
      this.#place = place;
      this.#refused.clear();
    }
    const had = !this.#running && this.key === key;
    if (had || this.#running?.key === key || this.#refused.has(key)) {
      this.#next = null;
      return;
    }
    this.#next = { key, question, long };
    if (!this.#running) this.#go();
    else if (this.#running.long) this.#running.stop.abort();
  }

  async #go() {
    while (this.#next) {
      const { key, question, long } = this.#next;
      this.#next = null;
      this.#running = { key, long, stop: new AbortController() };
      try {
        this.answer = await this.#ask(question, this.#running.stop.signal);
        this.key = key;
      } catch (error) {
        if (error.name !== "AbortError") {
          this.#refused.set(key, error.message);
          this.#failed(error.message);
        }
      }
      this.#running = null;
      this.#arrived();
    }
  }
}

/** Read the facts of a person with feedback and noise: infinite numbers are words in JSON. */
export async function factsFrom(response) {
  const facts = await response.json();
  for (const key of ["critical_delay", "delay_margin", "critical_frequency", "unstable_roots"]) {
    if (key in facts) facts[key] = decoded(facts[key]);
  }
  for (const [key, value] of Object.entries(facts.sway ?? {})) {
    facts.sway[key] = key === "covariance" ? value.map((row) => row.map(decoded)) : decoded(value);
  }
  return facts;
}
