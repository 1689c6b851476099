// SPDX-License-Identifier: BSD-3-Clause
// One column against another: a coupler curve, a phase portrait.
import uPlot from 'uplot';
import { button, make } from './dom.js';
import { pngOf } from './export.js';
import { padded } from './marks.js';
import { axisStyle, drawnBy, facets, titleOf } from './plots.js';
import { cubics, pathThrough, slopesOf, valueAt } from './slopes.js';
import { theme } from './theme.js';

export class Against {
  constructor(data, clock, holder) {
    Object.assign(this, { data, clock, holder });
    const n = data.table.columns.length;
    this.x = n > 1 ? 1 : 0;
    this.y = n > 2 ? 2 : 0;
    this.addChoice();
    clock.addEventListener('time', () => this.showTime());
    new ResizeObserver(() => this.build()).observe(this.body);
  }

  addChoice() {
    const head = make('header');
    const choose = (label, key) => {
      const wrap = make('label', `${label} `),
        select = make('select');
      this.data.table.columns.forEach((column, i) =>
        select.add(new Option(titleOf(column).slice(0, 80), i, false, i === this[key])),
      );
      select.addEventListener('change', () => {
        this[key] = Number(select.value);
        this.build();
      });
      wrap.append(select);
      return wrap;
    };
    const save = () => this.plot && pngOf(this.plot, 'against.png');
    const png = button('PNG', save, { title: 'Save this plot as a picture' });
    head.append(choose('y', 'y'), choose('against x', 'x'), png);
    this.body = make('div', undefined, { className: 'against' });
    this.holder.append(head, this.body);
  }

  build() {
    const width = this.body.clientWidth;
    if (width === 0 || this.data.table.columns[0].values.length < 2) return;
    this.plot?.destroy();
    this.slopes = [this.x, this.y].map((i) => slopesOf(this.data, i));
    const [cx, cy] = [this.data.table.columns[this.x], this.data.table.columns[this.y]];
    const paths = (u, k) => this.way(u, k);
    const axis = (column, size) => ({ ...axisStyle(), label: titleOf(column).slice(0, 60), labelSize: 16, size });
    this.plot = new uPlot(
      {
        mode: 2,
        width,
        height: Math.min(360, Math.max(220, width * 0.7)),
        padding: [10, 12, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, range: padded }, y: { range: padded } },
        axes: [axis(cx, 30), axis(cy, 60)],
        series: [
          {},
          { label: cy.name.slice(0, 60), stroke: theme.color(0), width: 1.6, facets: facets(), paths },
        ],
      },
      [null, [cx.values, cy.values]],
      this.body,
    );
    this.dot = make('div', undefined, { className: 'dot' });
    this.plot.over.append(this.dot);
    this.showTime();
  }

  showTime() {
    if (!this.plot) return;
    const [x, y] = ['x', 'y'].map((key, k) =>
      this.plot.valToPos(valueAt(this.data, this.slopes[k], this[key], this.clock.t), key),
    );
    this.dot.style.transform = `translate(${x}px, ${y}px)`;
    this.dot.hidden = !(Number.isFinite(x) && Number.isFinite(y));
  }

  // The points joined in the order of time. Of very long columns every k-th is drawn.
  way(u, seriesIdx) {
    return drawnBy(u, seriesIdx, (place, series) => {
      const [xs, ys] = u.data[seriesIdx],
        every = Math.max(1, Math.floor(xs.length / 20000)),
        points = [];
      for (let i = 0; i < xs.length; i += every)
        points.push(Number.isFinite(xs[i]) && Number.isFinite(ys[i]) ? place(xs[i], ys[i]) : null);
      const smooth = xs.length < 1500;
      const known = smooth && this.slopes.every((s) => s),
        { marks, table } = this.data;
      const path = known
        ? cubics(points, place, [xs, ys], this.slopes, table.columns[0].values, marks)
        : pathThrough(points, (i) => (smooth ? rounded(points, i) : null));
      u.ctx.strokeStyle = series.stroke();
      u.ctx.lineWidth = series.width * devicePixelRatio;
      u.ctx.lineJoin = 'round';
      u.ctx.stroke(path);
    });
  }
}

// The middle points of the cubic to point i whose slopes are those from neighbour to neighbour.
function rounded(points, i) {
  const [before, p] = points.slice(i - 1, i + 1);
  const [a, b] = [points[i - 2] ?? before, points[i + 1] ?? p];
  return [...before.map((x, k) => x + (p[k] - a[k]) / 6), ...p.map((x, k) => x - (b[k] - before[k]) / 6)];
}
