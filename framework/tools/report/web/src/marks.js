// SPDX-License-Identifier: BSD-3-Clause
// Marks of a scatter plot: dots, cells of a map, lines between them; their colours.
import { theme } from './theme.js';

// From blue over green to orange: for numbers.
const SCALE = [
  [0, 114, 178],
  [0, 158, 115],
  [230, 159, 0],
  [213, 94, 0],
];

export function shade(u) {
  const at = Math.min(0.9999, Math.max(0, u)) * (SCALE.length - 1);
  const k = Math.floor(at);
  return `rgb(${SCALE[k].map((c, i) => Math.round(c + (at - k) * (SCALE[k + 1][i] - c))).join()})`;
}

// Least and largest of the finite numbers among `values` at `members`.
export function extentOf(values, members) {
  let low = Infinity;
  let high = -Infinity;
  for (const i of members) {
    if (values[i] < low) low = values[i];
    if (values[i] > high) high = values[i];
  }
  return [low, high];
}

// Whether more than rounding lies between two numbers.
export const varies = (low, high) => high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high));

// A little more than the points for an axis of uPlot. What only rounding tells apart is no range.
export function padded(u, low, high) {
  const more = varies(low, high) ? 0.05 * (high - low) : 0.05 * Math.abs(low) || 1;
  return [low - more, high + more];
}

export function colorFor(value, [low, high]) {
  return Number.isFinite(value) ? shade((value - low) / (high - low || 1)) : theme.is.ground;
}

// The size of a cell where points, in pixels, fill a grid; else null.
export function cellOf(points) {
  const steps = [0, 1].map((k) => {
    const values = [...new Set(points.map((p) => Math.round(p[k] * 100)))].sort((a, b) => a - b);
    return { n: values.length, step: Math.min(...values.slice(1).map((v, i) => v - values[i])) / 100 };
  });
  const full = steps.every(({ n }) => n > 2 && n < 400) && points.length > 0.7 * steps[0].n * steps[1].n;
  return full ? steps.map(({ step }) => step + 0.6) : null;
}

export function drawLine(ctx, points, color) {
  ctx.beginPath();
  points.forEach(([x, y], k) => (k === 0 ? ctx.moveTo(x, y) : ctx.lineTo(x, y)));
  ctx.strokeStyle = color;
  ctx.lineWidth = 1.2 * devicePixelRatio;
  ctx.stroke();
}

export function drawMarks(ctx, points, tint, cell) {
  points.forEach(([x, y], k) => {
    ctx.fillStyle = tint(k);
    ctx.beginPath();
    if (cell) ctx.rect(x - cell[0] / 2, y - cell[1] / 2, ...cell);
    else ctx.arc(x, y, 3.6 * devicePixelRatio, 0, 2 * Math.PI);
    ctx.fill();
  });
}
