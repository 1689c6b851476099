// SPDX-License-Identifier: BSD-3-Clause
// Plots: the recorded columns over time, one panel per unit or as the scene asks; their cursor is the page's time.
import uPlot from 'uplot';
import { button, make, press, whenClicked } from './dom.js';
import { pngOf, saveCsv } from './export.js';
import { extentOf } from './marks.js';
import { indexAt } from './motion.js';
import { hermite, slopesOf } from './slopes.js';
import { theme } from './theme.js';

const MOST_CURVES = 8; // of a panel
const MOST_MARKS = 60; // more would be a hatching
const SMOOTH = 1500; // rows, from which on they are joined straight
const HEIGHT = 190; // pixels

// Groups of column numbers with a title: those of the scene, each split by unit, then one for each unit; a group is no larger than can be read.
export function groupsOf(data) {
  const { columns } = data.table;
  const byName = new Map(columns.map((c, i) => [c.name, i]));
  const groups = [],
    taken = new Set();
  for (const names of data.text.panels) {
    const members = names.map((n) => byName.get(n)).filter((i) => i !== undefined);
    members.forEach((i) => taken.add(i));
    for (const unit of new Set(members.map((i) => columns[i].unit)))
      groups.push({ unit, members: members.filter((i) => columns[i].unit === unit) });
  }
  const byUnit = new Map();
  columns.forEach((column, i) => {
    if (i === 0 || taken.has(i) || column.before) return;
    if (!byUnit.has(column.unit)) byUnit.set(column.unit, []);
    byUnit.get(column.unit).push(i);
  });
  for (const [unit, members] of byUnit)
    for (let i = 0; i < members.length; i += MOST_CURVES)
      groups.push({ unit, members: members.slice(i, i + MOST_CURVES) });
  // The columns before a search follow all others, in the same order.
  if (data.before) for (const { members } of groups) members.push(...members.map((i) => i + (columns.length - 1) / 2));
  return groups;
}

// uPlot leaves a gap where a value is null.
function drawable(values) {
  return values.every(Number.isFinite) ? values : Array.from(values, (v) => (Number.isFinite(v) ? v : null));
}

export function number(value) {
  if (!Number.isFinite(value)) return '\u2013';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return Number(value.toPrecision(4)).toExponential();
  return Number(value.toPrecision(5)).toString();
}

// Numbers of an axis, with as many digits as tell neighbours apart; on logarithmic axes some ticks have none.
function tickTexts(u, ticks, axis, space, step) {
  const largest = Math.max(...ticks.map((v) => Math.abs(v ?? 0)));
  const logarithmic = u.scales[u.axes[axis].scale].distr === 3;
  if (logarithmic) return ticks.map((v) => (v === null ? '' : number(v)));
  let digits = 0; // after the point, so that the step is whole
  while (digits < 15 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6) ++digits;
  if (digits <= 6 && largest < 1e6) return ticks.map((v) => v.toFixed(digits));
  const significant = Math.min(12, Math.max(1, Math.ceil(Math.log10(largest / step)) + 1));
  return ticks.map((v) => (v === 0 ? '0' : v.toExponential(Math.max(0, significant - 1))));
}

const FONT = '11px system-ui, sans-serif';

// Values over time; of a long run extremes of groups of rows.
const curveOf = (column) => column.curve ?? column.values;

// Extremes of the motion beyond a column's rows: time, value, and the value that the curve reaches.
function beyondRows(column) {
  if (!column.range) return [];
  const curve = curveOf(column);
  const [low, high] = extentOf(curve, curve.keys());
  const { least, t_least, most, t_most } = column.range;
  return [...(least < low ? [[t_least, least, low]] : []), ...(most > high ? [[t_most, most, high]] : [])];
}

export const titleOf = (column) => (column.unit ? `${column.name} [${column.unit}]` : column.name);

export const axisStyle = () => ({
  values: tickTexts,
  stroke: theme.is.soft,
  font: FONT,
  labelFont: FONT,
  grid: { stroke: theme.is.plotGrid, width: 1 },
  ticks: { stroke: theme.is.plotGrid, width: 1, size: 4 },
});

// Of a series that has both coordinates; uPlot keeps its extent in them.
export const facets = () => ['x', 'y'].map((scale) => ({ scale, auto: true }));

// A series as `paint` draws it within the axes, which is given a function for the place of a point.
export function drawnBy(u, seriesIdx, paint) {
  uPlot.orient(u, seriesIdx, (series, xs, ys, scaleX, scaleY, toX, toY, left, top, wide, high) => {
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(left, top, wide, high);
    u.ctx.clip();
    paint((x, y) => [toX(x, scaleX, wide, left), toY(y, scaleY, high, top)], series);
    u.ctx.restore();
  });
  return null;
}

export class Plots {
  constructor(data, clock, holder) {
    Object.assign(this, { data, clock, holder });
    this.groups = groupsOf(data).map((group) => ({ ...group, log: false, hidden: new Set() }));
    this.x = curveOf(data.table.columns[0]);
    this.beyond = data.table.columns.map(beyondRows);
    this.plots = [];
    clock.addEventListener('time', () => this.showTime());
    new ResizeObserver(() => this.resize()).observe(holder);
    // A panel is drawn when it comes into view: a run may have hundreds.
    this.views = new IntersectionObserver(
      (entries) => entries.forEach((entry) => entry.isIntersecting && this.fill(entry.target)),
      { rootMargin: '200px' },
    );
  }

  get full() {
    return [this.x[0], this.x[this.x.length - 1]];
  }

  build() {
    for (const { plot } of this.plots) plot.destroy();
    this.views.disconnect();
    this.holder.replaceChildren();
    this.plots = [];
    this.range = this.full;
    if (this.groups.length === 0 || this.x.length < 2) {
      const words = this.groups.length === 0 ? 'Only the time was recorded.' : 'A curve needs at least two rows.';
      this.holder.append(make('p', words, { className: 'note' }));
      return;
    }
    for (const group of this.groups) this.addPanel(group);
    this.showTime();
  }

  addPanel(group) {
    const panel = make('section', undefined, { className: 'plot' }),
      head = make('header'),
      body = make('div', undefined, { group });
    const change = () => {
      group.log = !group.log;
      this.build();
    };
    const log = button('log', change, { title: 'Logarithmic axis' });
    press(log, group.log);
    const picture = () =>
      pngOf(this.plots.find((p) => p.group === group).plot, `${this.fileName()}_${group.unit || 'plot'}.png`);
    const save = button('PNG', picture, { title: 'Save this plot as a picture' });
    head.append(make('h3', group.unit === '' ? 'without unit' : group.unit), log, save);
    body.style.minHeight = `${HEIGHT + 28}px`;
    panel.append(head, body);
    this.holder.append(panel);
    this.views.observe(body);
  }

  fill(body) {
    this.views.unobserve(body);
    const plot = this.makePlot(body.group, body);
    const mark = make('div', undefined, { className: 'time-mark' });
    plot.over.append(mark);
    this.plots.push({ plot, group: body.group, mark, body });
    plot.setScale('x', { min: this.range[0], max: this.range[1] });
    queueMicrotask(() => this.showTime());
  }

  fileName() {
    return (this.data.text.title || 'report').replace(/[^\p{L}\p{N}]+/gu, '_').slice(0, 60);
  }

  columnsOf(group) {
    return group.members.map((i) => this.data.table.columns[i]);
  }

  // A logarithmic axis has no place for numbers that are not above zero.
  dataOf(group) {
    const columns = this.columnsOf(group).map((column) => drawable(curveOf(column)));
    const positive = (y) => Array.from(y, (v) => (v > 0 ? v : null));
    return [this.x, ...(group.log ? columns.map(positive) : columns)];
  }

  // Few rows are joined without corners: by their rates where these are known, else by a guess.
  pathsOf(group, i) {
    if (this.x.length >= SMOOTH || this.data.table.stride > 1) return uPlot.paths.linear();
    const slopes = [0, group.members[i]].map((k) => slopesOf(this.data, k));
    return slopes[1] && !group.log ? hermite(slopes, this.data.marks) : uPlot.paths.spline();
  }

  makePlot(group, body) {
    const columns = this.columnsOf(group);
    const options = {
      width: Math.max(200, body.clientWidth || this.holder.clientWidth - 24),
      height: HEIGHT,
      padding: [8, 12, 0, 0],
      legend: { live: true },
      cursor: {
        sync: { key: 'time' },
        drag: { x: true, y: false },
        bind: { dblclick: () => () => this.zoom(this.full) },
        points: { size: 6 },
      },
      scales: { x: { time: false }, y: { distr: group.log ? 3 : 1, range: (u, low, high) => this.rangeOf(group, low, high) } },
      axes: [
        { ...axisStyle(), size: 26, label: 't [s]', labelSize: 14 },
        { ...axisStyle(), size: 62 },
      ],
      series: [
        { label: 't [s]', value: (u, v) => number(v) },
        ...columns.map((column, i) => ({
          label: column.name.length > 60 ? `${column.name.slice(0, 59)}\u2026` : column.name,
          stroke: theme.color(column.before ? i - columns.length / 2 : i),
          dash: i > 6 ? [6, 3] : undefined, // the colours begin again
          ...(column.before ? { width: 0.8, alpha: 0.7 } : { width: 1.6 }),
          pxAlign: 0,
          paths: this.pathsOf(group, i),
          show: !group.hidden.has(i),
          points: { show: false },
          value: (u, v) => number(v),
        })),
      ],
      hooks: {
        drawClear: [(u) => this.drawMarks(u)],
        draw: [(u) => this.drawBeyond(u, group)],
        setScale: [(u, key) => key === 'x' && this.zoomed(u)],
        setSeries: [(u, i, { show }) => show !== undefined && i > 0 && group.hidden[show ? 'delete' : 'add'](i - 1)],
      },
    };
    const plot = new uPlot(options, this.dataOf(group), body);
    const timeAt = (e) => plot.posToVal(e.clientX - plot.over.getBoundingClientRect().left, 'x');
    whenClicked(plot.over, (e) => this.clock.stopAt(timeAt(e)));
    plot.over.addEventListener('mouseleave', () => this.showTime());
    return plot;
  }

  // Those in view, of the columns that are shown.
  beyondOf(group) {
    const inView = ([t, v]) => t >= this.range[0] && t <= this.range[1] && (!group.log || v > 0);
    return group.members.flatMap((k, i) =>
      group.hidden.has(i) ? [] : this.beyond[k].filter(inView).map(([t, v, end]) => ({ i, t, v, end })),
    );
  }

  rangeOf(group, first, last) {
    if ((first ?? null) === null) return [null, null];
    const all = [first, last, ...this.beyondOf(group).map(({ v }) => v)];
    const [low, high] = [Math.min(...all), Math.max(...all)];
    return group.log ? uPlot.rangeLog(low, high, 10, true) : uPlot.rangeNum(low, high, 0.1, true);
  }

  // Rings at extremes that the curve does not reach.
  drawBeyond(u, group) {
    const { ctx } = u;
    ctx.save();
    ctx.lineWidth = 1.6 * devicePixelRatio;
    for (const { i, t, v, end } of this.beyondOf(group)) {
      const [x, y, reached] = [u.valToPos(t, 'x', true), u.valToPos(v, 'y', true), u.valToPos(end, 'y', true)];
      if (Math.abs(y - reached) < ctx.lineWidth) continue;
      ctx.strokeStyle = theme.color(i);
      ctx.beginPath();
      ctx.arc(x, y, 2 * ctx.lineWidth, 0, 2 * Math.PI);
      ctx.stroke();
    }
    ctx.restore();
  }

  // Events and impacts, as lines behind the curves.
  drawMarks(u) {
    if (this.data.marks.length > MOST_MARKS) return;
    const { ctx } = u;
    const { left, top, width, height } = u.bbox;
    ctx.save();
    ctx.strokeStyle = theme.is.line;
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
    for (const { t } of this.data.marks) {
      const x = u.valToPos(t, 'x', true);
      if (x >= left && x <= left + width) ctx.stroke(new Path2D(`M${x} ${top} v${height}`));
    }
    ctx.restore();
  }

  // One panel was zoomed: the others follow.
  zoomed(u) {
    const { min, max } = u.scales.x;
    if (this.zooming || (min ?? null) === null || this.plots.length === 0) return;
    if (min !== this.range[0] || max !== this.range[1]) this.zoom([min, max]);
  }

  zoom(range) {
    this.zooming = true;
    this.range = range;
    for (const { plot } of this.plots) plot.batch(() => plot.setScale('x', { min: range[0], max: range[1] }));
    // What uPlot decides at the end of its batch is no wish of the reader's.
    queueMicrotask(() => {
      this.zooming = false;
      this.showTime();
    });
  }

  // The cursor of time, and the values there.
  showTime() {
    const { t } = this.clock;
    for (const { plot, mark } of this.plots) {
      const x = plot.valToPos(t, 'x');
      mark.style.transform = `translateX(${x}px)`;
      mark.hidden = !(x >= 0 && x <= plot.over.clientWidth);
      if (plot.cursor.left < 0 || plot.cursor.left === undefined)
        plot.setLegend({ idx: indexAt(plot.data[0], t) }, false);
    }
  }

  resize() {
    const width = this.holder.clientWidth;
    if (width === 0 || width === this.width) return;
    this.width = width;
    if (!this.range) this.build();
    for (const { plot, body } of this.plots) plot.setSize({ width: Math.max(200, body.clientWidth), height: HEIGHT });
    this.showTime();
  }

  saveCsv() {
    const { columns } = this.data.table;
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const lines = [columns.map((c) => quoted(titleOf(c))).join()];
    // Columns in single precision have 7 digits, and those with a base more.
    const digits = (c) => (c.values instanceof Float32Array ? (v) => Number(v.toPrecision(8)) : (v) => v);
    const forms = columns.map(digits);
    for (let i = 0; i < this.x.length; ++i) lines.push(columns.map((c, k) => forms[k](c.values[i])).join());
    saveCsv(`${this.fileName()}.csv`, `${lines.join('\n')}\n`);
  }
}
