/** Round numbers for axes, colours and contours; pure. */
import { shortNumber } from "./content.js";

/** Round numbers between two ends, at most so many steps of 1, 2, 2.5 or 5 times a power of 10. */
export function roundNumbers(low, high, most = 6) {
  const step = roundStep(low, high, most);
  if (!(step > 0)) return [];
  const numbers = [];
  const first = Math.ceil(low / step - 1e-9);
  // counted, as adding 1 to a large number may change nothing
  const count = Math.min(Math.floor(high / step + 1e-9) - first + 1, 2 * most);
  for (let i = 0; i < count; i++) numbers.push(Number(((first + i) * step).toPrecision(12)));
  return numbers;
}

/** The step of those numbers. */
export function roundStep(low, high, most = 6) {
  const raw = (high - low) / most;
  if (!(raw > 0) || !Number.isFinite(raw)) return 0;
  const power = 10 ** Math.floor(Math.log10(raw));
  const factor = [1, 2, 2.5, 5, 10].find((each) => each * power >= raw * (1 - 1e-9));
  return factor * power;
}

/** Both ends moved out to round numbers. */
export function roundEnds(low, high, most = 6) {
  const step = roundStep(low, high, most);
  if (!(step > 0)) return [low - 0.5, high + 0.5];
  const clean = (value) => Number(value.toPrecision(12));
  return [clean(Math.floor(low / step + 1e-9) * step), clean(Math.ceil(high / step - 1e-9) * step)];
}

/**
 * Marks of an axis in the coordinates of the map: its values, or their logarithms.
 * @returns {{places: number[], words: Map<number, string>}}
 */
export function marksOf(low, high, logarithmic, most = 7) {
  let places = roundNumbers(low, high, most);
  let value = (place) => place;
  if (logarithmic) {
    value = (place) => 10 ** place;
    const factors = high - low > 2.5 ? [1] : [1, 2, 5];
    places = [];
    for (let power = Math.floor(low); power <= high; power++) {
      for (const factor of factors) places.push(power + Math.log10(factor));
    }
    places = places.filter((place) => place >= low && place <= high);
  }
  return { places, words: new Map(places.map((place) => [place, shortNumber(value(place))])) };
}
