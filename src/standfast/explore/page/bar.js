/** The bar of colours below the map. */
import { cssColour } from "./colours.js";
import { labelOf, shortNumber } from "./content.js";
import { roundNumbers } from "./ticks.js";

const HEIGHT = 54;

/**
 * Draw the bar of a scale, with its unit, what is clipped, and what is hatched.
 * @param {CanvasRenderingContext2D} context
 * @param {{ink: string, font: string}} look
 */
export function drawBar(context, width, quantity, scale, { ink, font }) {
  context.font = `12px ${font}`;
  context.textBaseline = "alphabetic";
  context.fillStyle = ink;
  if (scale.kind === "flags") {
    drawFlags(context, width, scale, ink);
    return;
  }
  const [left, right] = [26, width - 26];
  const step = (right - left) / 256;
  for (let i = 0; i < 256; i++) {
    const value = scale.low + ((i + 0.5) / 256) * (scale.high - scale.low);
    context.fillStyle = cssColour(scale, value);
    context.fillRect(left + i * step, 20, step + 1, 12);
  }
  drawEnd(context, scale, left, -1, scale.low);
  drawEnd(context, scale, right, 1, scale.high);
  context.fillStyle = ink;
  context.textAlign = "center";
  const count = Math.max(2, Math.min(8, Math.floor(width / 70)));
  for (const value of roundNumbers(scale.low, scale.high, count)) {
    const at = left + ((value - scale.low) / (scale.high - scale.low)) * (right - left);
    context.fillRect(at - 0.5, 32, 1, 4);
    context.fillText(shortNumber(value), at, 48);
  }
  context.textAlign = "left";
  const falls = scale.hatched ? ", hatched: falls" : "";
  context.fillText(`${labelOf(quantity)}${falls}`, left, 13);
  if (!Number.isFinite(scale.limit)) return;
  const at = left + ((scale.limit - scale.low) / (scale.high - scale.low)) * (right - left);
  context.fillStyle = "#d55e00";
  context.fillRect(at - 1.5, 17, 3, 18);
}

// an arrow at each end: values beyond have the colour of the end
function drawEnd(context, scale, at, way, value) {
  context.fillStyle = cssColour(scale, value);
  context.beginPath();
  context.moveTo(at, 20);
  context.lineTo(at + way * 10, 26);
  context.lineTo(at, 32);
  context.fill();
}

function drawFlags(context, width, scale, ink) {
  context.textAlign = "left";
  const words = ["falls (hatched)", "stands"];
  words.forEach((word, i) => {
    const at = 26 + i * Math.min(160, width / 2.2);
    context.fillStyle = cssColour(scale, i);
    context.fillRect(at, 16, 26, 16);
    if (i === 0) {
      context.strokeStyle = "#b24a00";
      context.lineWidth = 1.5;
      context.beginPath();
      for (let x = at; x < at + 26; x += 7) {
        context.moveTo(x, 32);
        context.lineTo(Math.min(x + 16, at + 26), Math.max(16, 32 - (at + 26 - x)));
      }
      context.stroke();
    }
    context.fillStyle = ink;
    context.fillText(word, at + 32, 28);
  });
}

/** Show the bar in its canvas, sharp on any screen; and say it in words. */
export function showScale(canvas, quantity, scale, look) {
  const ratio = globalThis.devicePixelRatio || 1;
  const key = scale && JSON.stringify([canvas.dataset.width, ratio, quantity.name, scale, look]);
  // asked for its width only where something changed, as that makes the browser lay out the page
  if (canvas.dataset.shown === String(key)) return;
  canvas.dataset.shown = String(key);
  canvas.hidden = !scale;
  if (!scale) return;
  const width = canvas.clientWidth;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(HEIGHT * ratio);
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  drawBar(context, width, quantity, scale, look);
  const ends = `${shortNumber(scale.low)} to ${shortNumber(scale.high)}`;
  const falls = scale.hatched ? ", hatched: falls" : "";
  const words =
    scale.kind === "flags" ? "falls, hatched, and stands" : `colours from ${ends}${falls}`;
  canvas.setAttribute("aria-label", `${labelOf(quantity)}: ${words}`);
}
