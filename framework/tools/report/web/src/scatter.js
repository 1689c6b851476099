// SPDX-License-Identifier: BSD-3-Clause
// A scatter plot: points by two columns, coloured by group or by a third column.
import uPlot from 'uplot';
import { make, whenClicked } from './dom.js';
import { cellOf, colorFor, drawLine, drawMarks, extentOf, padded } from './marks.js';
import { axisStyle, drawnBy, facets } from './plots.js';

const NEAR = 14; // pixels

const range = (log) => (log ? (u, low, high) => [low / 1.6, high * 1.6] : padded);
const scale = (log) => ({ time: false, distr: log ? 3 : 1, range: range(log) });
const axis = (title, size) => ({ ...axisStyle(), label: title.slice(0, 80), labelSize: 18, size });

// On a logarithmic axis, runs that blew up to numbers without meaning would press all others together.
function limitOf({ numbers, log }) {
  const given = log ? numbers.filter((v) => Number.isFinite(v) && v > 0).sort((a, b) => a - b) : [];
  return given.length > 0 ? 1e4 * given[Math.floor(0.75 * (given.length - 1))] : Infinity;
}

export class Scatter {
  // `onPoint` is told the number of the point under the mouse, `onClick` that of one that is clicked.
  constructor(holder, onPoint, onClick) {
    Object.assign(this, { holder, onPoint, onClick });
    this.seen = [];
  }

  // what: x and y with title, numbers and log; groups with name, color and members; colors, a column or null; joined.
  draw(what) {
    this.plot?.destroy();
    this.plot = null;
    this.what = what;
    const limits = { x: limitOf(what.x), y: limitOf(what.y) };
    const fits = (key, i) => {
      const { numbers, log } = what[key];
      return Number.isFinite(numbers[i]) && (!log || (numbers[i] > 0 && numbers[i] <= limits[key]));
    };
    const fitting = (members) => members.filter((i) => fits('x', i) && fits('y', i));
    this.groups = what.groups.map((g) => ({ ...g, members: fitting(g.members) }));
    this.seen = this.groups.flatMap((g) => g.members);
    this.extent = what.colors ? extentOf(what.colors.numbers, this.seen) : null;
    if (this.seen.length > 0) this.plot = this.make();
  }

  make() {
    const { x, y } = this.what;
    const series = (g) => ({ label: g.name, stroke: g.color, facets: facets(), paths: (u, k) => this.paint(u, k, g) });
    const plot = new uPlot(
      {
        mode: 2,
        width: this.holder.clientWidth,
        height: Math.max(300, Math.min(620, innerHeight - 260)),
        padding: [12, 16, 0, 0],
        legend: { show: false },
        cursor: { drag: { x: true, y: true }, points: { show: false }, x: false, y: false },
        scales: { x: scale(x.log), y: scale(y.log) },
        axes: [axis(x.title, 34), axis(y.title, 66)],
        series: [{}, ...this.groups.map(series)],
      },
      [null, ...this.groups.map((g) => [g.members.map((i) => x.numbers[i]), g.members.map((i) => y.numbers[i])])],
      this.holder,
    );
    this.ring = make('div', undefined, { className: 'ring', hidden: true });
    plot.over.append(this.ring);
    const telling = (call) => (e) => {
      const i = this.nearest(e);
      if (i >= 0) call(i);
    };
    plot.over.addEventListener('mousemove', telling(this.onPoint));
    whenClicked(plot.over, telling(this.onClick));
    return plot;
  }

  paint(u, seriesIdx, { members, color }) {
    return drawnBy(u, seriesIdx, (place) => {
      const { x, y, colors, joined } = this.what;
      const points = members.map((i) => place(x.numbers[i], y.numbers[i]));
      if (joined) drawLine(u.ctx, points, color);
      const tint = colors ? (k) => colorFor(colors.numbers[members[k]], this.extent) : () => color;
      drawMarks(u.ctx, points, tint, colors && !x.log && !y.log ? cellOf(points) : null);
    });
  }

  placeOf(i) {
    const { x, y } = this.what;
    return [this.plot.valToPos(x.numbers[i], 'x'), this.plot.valToPos(y.numbers[i], 'y')];
  }

  // The point under the mouse; -1: none.
  nearest(e) {
    const box = this.plot.over.getBoundingClientRect();
    let best = -1;
    let least = NEAR;
    for (const i of this.seen) {
      const [x, y] = this.placeOf(i);
      const d = Math.hypot(x - (e.clientX - box.left), y - (e.clientY - box.top));
      if (d < least) [best, least] = [i, d];
    }
    return best;
  }

  // A ring about a point; -1: none.
  mark(i) {
    if (!this.plot) return;
    this.ring.hidden = !this.seen.includes(i);
    if (this.ring.hidden) return;
    const [x, y] = this.placeOf(i);
    this.ring.style.transform = `translate(${x}px, ${y}px)`;
  }
}
