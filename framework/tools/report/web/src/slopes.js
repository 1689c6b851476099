// SPDX-License-Identifier: BSD-3-Clause
// Slopes of columns at their rows, where the page knows their rates: curves between rows are then cubics through values
// and rates, as the motion of the picture is, and need not be guessed.
import uPlot from 'uplot';
import { indexAt } from './motion.js';

const AXES = 'xyz';

// The number within a frame of the velocity that is the rate of a channel; -1: none is.
function velocityOf(channel, { mechanism }) {
  const dot = channel.lastIndexOf('.');
  const owner = mechanism.moving.findIndex((i) => mechanism.bodies[i].name === channel.slice(0, dot));
  if (owner < 0) return -1;
  const what = channel.slice(dot + 1);
  if (what.length === 1 && AXES.includes(what)) return 13 * owner + 7 + AXES.indexOf(what);
  const axis = /^angle_([xyz])$/.exec(what);
  return axis && AXES.indexOf(axis[1]) === mechanism.plane ? 13 * owner + 10 + mechanism.plane : -1;
}

// Channels that are the rate of another: body.vx of body.x, body.ax of body.vx, A.angle_z_d of A.angle_z.
function ratesOf(channel) {
  return [rateOf(channel), `${channel}_d`, channel.endsWith('_d') ? `${channel}d` : ''].filter((name) => name !== '');
}

function rateOf(channel) {
  const dot = channel.lastIndexOf('.'),
    [owner, what] = [channel.slice(0, dot + 1), channel.slice(dot + 1)];
  const parts = /^(center_)?([va]?)([xyz])$/.exec(what);
  if (parts && parts[2] !== 'a') return `${owner}${parts[1] ?? ''}${parts[2] === '' ? 'v' : 'a'}${parts[3]}`;
  const omega = /^omega_(world|body)_([xyz])$/.exec(what);
  return omega ? `${owner}alpha_${omega[1]}_${omega[2]}` : '';
}

// Slopes before and after each row, which differ where something acted; NaN where they are not known. null: of no row.
export function slopesOf(data, index) {
  const { columns } = data.table,
    times = columns[0].values;
  if (index === 0) return { before: times.map(() => 1), after: times.map(() => 1) };
  const channels = new Map(data.text.channels);
  const channelOf = (column) => channels.get(column.name) ?? column.name;
  const channel = channelOf(columns[index]);
  const at = velocityOf(channel, data);
  if (at >= 0) return ofFrames(data, times, at);
  const rates = ratesOf(channel),
    column = columns.find((c) => rates.includes(channelOf(c)));
  if (!column) return null;
  // A row at which something acted has the rate after it.
  const acted = new Set(data.marks.map((m) => m.t));
  return {
    before: Array.from(column.values, (v, i) => (acted.has(times[i]) ? NaN : v)),
    after: column.values,
  };
}

// null where too few rows have a frame: of a thinned history other rows than frames may have been kept.
function ofFrames({ frames }, times, at) {
  const jumps = new Set(frames.jumps);
  const before = new Float64Array(times.length).fill(NaN),
    after = new Float64Array(times.length).fill(NaN);
  for (let i = 0; i < times.length; ++i) {
    const k = indexAt(frames.times, times[i]);
    if (frames.times[k] !== times[i]) continue;
    after[i] = frames.rows[k * frames.width + at];
    if (!jumps.has(k)) before[i] = after[i];
    else if (frames.times[k - 1] === times[i]) before[i] = frames.rows[(k - 1) * frames.width + at];
  }
  const known = after.reduce((n, slope) => n + (Number.isFinite(slope) ? 1 : 0), 0);
  return 2 * known >= times.length ? { before, after } : null;
}

// Whether the interval before row i is a cubic.
export function isCubic(slopes, marks, times, i) {
  const known = slopes && Number.isFinite(slopes.after[i - 1]) && Number.isFinite(slopes.before[i]);
  return known && !marks.some(({ t }) => t > times[i - 1] && t < times[i]);
}

// A column at a time: by the cubic, else straight from row to row.
export function valueAt(data, slopes, index, t) {
  const times = data.table.columns[0].values,
    { values } = data.table.columns[index];
  const k = indexAt(times, t),
    next = Math.min(k + 1, times.length - 1),
    h = times[next] - times[k];
  if (!(h > 0)) return values[k];
  const u = Math.min(1, Math.max(0, (t - times[k]) / h)),
    v = 1 - u;
  const straight = v * values[k] + u * values[next];
  if (!isCubic(slopes, data.marks, times, next)) return straight;
  const [a, b] = [slopes.after[k] * h, slopes.before[next] * h],
    rise = values[next] - values[k];
  return straight + u * v * (v * (a - rise) - u * (b - rise));
}

// A path through points, where null is a gap. `middle(i)`: the middle points of the cubic to point i; null: it is straight.
export function pathThrough(points, middle) {
  const path = new Path2D();
  points.forEach((p, i) => {
    if (!p) return;
    const bend = points[i - 1] && middle(i);
    if (!points[i - 1]) path.moveTo(...p);
    else if (bend) path.bezierCurveTo(...bend, ...p);
    else path.lineTo(...p);
  });
  return path;
}

// Through the points of two columns: by cubics with these slopes, or straight where they are not known. `place`: the
// point of two numbers.
export function cubics(points, place, columns, slopes, times, marks) {
  return pathThrough(points, (i) => {
    if (!slopes.every((s) => isCubic(s, marks, times, i))) return null;
    const h = (times[i] - times[i - 1]) / 3;
    const after = columns.map((values, k) => values[i - 1] + h * slopes[k].after[i - 1]),
      before = columns.map((values, k) => values[i] - h * slopes[k].before[i]);
    return [...place(...after), ...place(...before)];
  });
}

// The same as a path of uPlot over time.
export function hermite(slopes, marks) {
  return (u, seriesIdx) => {
    let stroke = null;
    uPlot.orient(u, seriesIdx, (series, xs, ys, scaleX, scaleY, toX, toY, left, top, wide, high) => {
      const place = (x, y) => [toX(x, scaleX, wide, left), toY(y, scaleY, high, top)];
      const points = Array.from(ys, (y, i) => ((y ?? null) === null ? null : place(xs[i], y)));
      stroke = cubics(points, place, [xs, ys], slopes, xs, marks);
    });
    return { stroke };
  };
}
