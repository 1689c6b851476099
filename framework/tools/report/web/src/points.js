// The page of many runs: each is a point of a plot whose axes and colour are columns of their table.
import uPlot from 'uplot';
import { readTable } from './csv.js';
import { download, pngOf } from './export.js';
import { axisStyle, number } from './plots.js';
import { theme } from './theme.js';

const REASONS = ['failure', 'status']; // columns that say why a run failed
const MOST_ROWS = 1000; // shown as a table
const MOST_GROUPS = 12; // with a button each
const NEAR = 14; // pixels

const $ = (id) => document.getElementById(id);

// From blue over green to orange: for numbers.
const SCALE = [
  [0, 114, 178],
  [0, 158, 115],
  [230, 159, 0],
  [213, 94, 0],
];
function shade(u) {
  const at = Math.min(0.9999, Math.max(0, u)) * (SCALE.length - 1),
    k = Math.floor(at);
  return `rgb(${SCALE[k].map((c, i) => Math.round(c + (at - k) * (SCALE[k + 1][i] - c))).join()})`;
}

// The columns of words that tell runs apart.
function wordsOf({ columns }) {
  return columns.filter((c) => !c.numbers && !REASONS.includes(c.title) && new Set(c.texts).size > 1);
}

// Rows by all words of these columns: each group is a line.
function groupsOf({ rows }, words) {
  const groups = new Map();
  rows.forEach((_, i) => {
    const name =
      words
        .map((c) => c.texts[i])
        .filter((t) => t !== '')
        .join(', ') || 'runs';
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(i);
  });
  return [...groups].map(([name, members]) => ({ name, members }));
}

class Points {
  constructor(data) {
    this.data = data;
    this.table = readTable(data.csv);
    this.words = wordsOf(this.table);
    this.groups = groupsOf(this.table, this.words);
    this.by = this.groups.length > MOST_GROUPS || this.words.length === 1 ? 0 : -1; // what has one colour and one button
    this.hidden = new Set();
    this.numeric = this.table.columns.map((c, i) => (c.numbers ? i : -1)).filter((i) => i >= 0);
    const find = (title, other) => {
      const i = this.table.columns.findIndex((c) => c.title === title);
      return i >= 0 && this.table.columns[i].numbers
        ? i
        : (this.numeric[Math.min(other, this.numeric.length - 1)] ?? -1);
    };
    this.x = find(data.x, 0);
    this.y = find(data.y, 1);
    this.color = data.color ? find(data.color, -1) : -1;
    this.log = { x: data.log, y: data.log };
    this.joined = data.joined;
    this.picked = -1;
    this.addControls();
    this.addGroups();
    this.addTable();
    this.addAbout();
    new ResizeObserver(() => this.build()).observe($('points-plot'));
    theme.onChange(() => this.build());
  }

  addControls() {
    for (const key of ['x', 'y', 'color']) {
      const select = $(`points-${key}`);
      if (key === 'color')
        this.words.forEach((c, k) => select.add(new Option(`by ${c.title}`.slice(0, 80), `by ${k}`)));
      if (key === 'color') select.add(new Option(this.groups.length > 1 ? 'by all words' : 'one', 'by -1'));
      for (const i of this.numeric) select.add(new Option(this.table.columns[i].title.slice(0, 80), i));
      select.value = key === 'color' && this.color < 0 ? `by ${this.by}` : this[key];
      select.addEventListener('change', () => this.choose(key, select.value));
    }
    const toggle = (id, get, set) => {
      const press = () => $(id).setAttribute('aria-pressed', String(get()));
      press();
      $(id).addEventListener('click', () => {
        set(!get());
        press();
        this.build();
      });
    };
    toggle(
      'points-log-x',
      () => this.log.x,
      (on) => {
        this.log.x = on;
      },
    );
    toggle(
      'points-log-y',
      () => this.log.y,
      (on) => {
        this.log.y = on;
      },
    );
    toggle(
      'points-join',
      () => this.joined,
      (on) => {
        this.joined = on;
      },
    );
    $('points-png').addEventListener('click', () => this.plot && pngOf({ plot: this.plot }, 'runs.png'));
    $('points-csv').addEventListener('click', () =>
      download('runs.csv', new Blob([this.data.csv], { type: 'text/csv' })),
    );
  }

  choose(key, value) {
    if (value.startsWith('by ')) {
      this.color = -1;
      this.by = Number(value.slice(3));
      this.hidden.clear();
      this.addGroups();
    } else this[key] = Number(value);
    this.build();
  }

  // What a group is called among those that have one colour.
  nameOf(group) {
    return this.by < 0 ? group.name : this.words[this.by].texts[group.members[0]];
  }

  addGroups() {
    this.names = [...new Set(this.groups.map((g) => this.nameOf(g)))];
    $('points-groups').replaceChildren();
    if (this.names.length < 2) return;
    this.names.forEach((name, i) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = name.slice(0, 80) || 'none';
      button.style.setProperty('--tint', theme.color(i));
      button.setAttribute('aria-pressed', 'true');
      button.addEventListener('click', () => {
        this.hidden[this.hidden.has(name) ? 'delete' : 'add'](name);
        button.setAttribute('aria-pressed', String(!this.hidden.has(name)));
        this.build();
      });
      $('points-groups').append(button);
    });
  }

  addTable() {
    const t = document.createElement('table'),
      head = t.createTHead().insertRow();
    for (const c of this.table.columns) {
      const th = document.createElement('th');
      th.textContent = c.title;
      th.scope = 'col';
      head.append(th);
    }
    const body = t.createTBody();
    this.table.rows.slice(0, MOST_ROWS).forEach((cells, i) => {
      const row = body.insertRow();
      for (const cell of cells) row.insertCell().textContent = cell;
      row.addEventListener('click', () => this.pick(i));
    });
    $('points-table').append(t);
    const n = this.table.rows.length;
    if (n > MOST_ROWS) $('points-table').append(`The first ${MOST_ROWS} of ${n} rows; the CSV has all.`);
  }

  addAbout() {
    const { text } = this.data,
      about = $('points-about');
    const put = (kind, words) => {
      const e = document.createElement(kind);
      e.textContent = words;
      about.append(e);
    };
    if (text.description) put('p', text.description);
    for (const [name, value] of text.facts) put('p', `${name} ${value}`);
    put('p', `lockstep ${text.version}`);
    if (text.command) put('pre', text.command);
    put('pre', text.scene);
  }

  // A number can stand on an axis.
  fits(v, axis) {
    return Number.isFinite(v) && (!this.log[axis] || v > 0);
  }

  build() {
    const width = $('points-plot').clientWidth;
    if (width === 0 || this.x < 0 || this.y < 0) return;
    const { columns } = this.table,
      xs = columns[this.x].numbers,
      ys = columns[this.y].numbers;
    const shown = this.groups.filter((g) => !this.hidden.has(this.nameOf(g)));
    const seen = shown.map((g) => g.members.filter((i) => this.fits(xs[i], 'x') && this.fits(ys[i], 'y')));
    this.seen = seen.flat();
    this.plot?.destroy();
    this.plot = null;
    const missing = shown.reduce((n, g) => n + g.members.length, 0) - this.seen.length;
    $('points-note').textContent =
      missing > 0
        ? `${missing} ${missing === 1 ? 'run has' : 'runs have'} no point here: they failed, or have no such number; the table has their reasons.`
        : '';
    if (this.seen.length === 0) return;
    const axis = (column, size) => ({ ...axisStyle(), label: columns[column].title.slice(0, 80), labelSize: 18, size });
    const facet = (scale) => ({ scale, auto: true });
    this.plot = new uPlot(
      {
        mode: 2,
        width,
        height: Math.max(300, Math.min(620, innerHeight - 260)),
        padding: [12, 16, 0, 0],
        legend: { show: false },
        cursor: { drag: { x: true, y: true }, points: { show: false }, x: false, y: false },
        scales: { x: this.scale('x'), y: this.scale('y') },
        axes: [axis(this.x, 34), axis(this.y, 66)],
        series: [
          {},
          ...shown.map((g, k) => ({
            label: g.name,
            stroke: theme.color(this.names.indexOf(this.nameOf(g))),
            facets: [facet('x'), facet('y')],
            paths: (u, s) => this.paint(u, s, seen[k]),
          })),
        ],
      },
      [null, ...seen.map((members) => [members.map((i) => xs[i]), members.map((i) => ys[i])])],
      $('points-plot'),
    );
    this.ring = document.createElement('div');
    this.ring.className = 'ring';
    this.plot.over.append(this.ring);
    this.plot.over.addEventListener('mousemove', (e) => this.pick(this.nearest(e)));
    this.showScale();
    queueMicrotask(() => this.pick(this.picked)); // uPlot knows its scales by then
  }

  // Cells of a full grid fill the plane: a map.
  cellOf(u, at) {
    if (this.color < 0 || this.log.x || this.log.y) return null;
    const steps = [0, 1].map((k) => {
      const values = [...new Set(at.map((p) => Math.round(p[k] * 100)))].sort((a, b) => a - b);
      return { n: values.length, step: Math.min(...values.slice(1).map((v, i) => v - values[i])) / 100 };
    });
    const full = steps.every(({ n }) => n > 2 && n < 400) && at.length > 0.7 * steps[0].n * steps[1].n;
    return full ? steps.map(({ step }) => step + 0.6) : null;
  }

  // What the colours of numbers mean.
  showScale() {
    const holder = $('points-scale');
    holder.hidden = this.color < 0;
    if (this.color < 0) return;
    const values = this.seen.map((i) => this.table.columns[this.color].numbers[i]).filter(Number.isFinite);
    const ends = [
      values.reduce((a, b) => Math.min(a, b), Infinity),
      values.reduce((a, b) => Math.max(a, b), -Infinity),
    ];
    const bar = document.createElement('i');
    bar.style.background = `linear-gradient(to right, ${[0, 0.25, 0.5, 0.75, 1].map(shade).join()})`;
    holder.replaceChildren(
      `${this.table.columns[this.color].title.slice(0, 80)}: ${number(ends[0])} `,
      bar,
      ` ${number(ends[1])}`,
    );
  }

  // A little more than the points.
  scale(axis) {
    if (this.log[axis]) return { time: false, distr: 3, range: (u, low, high) => [low / 1.6, high * 1.6] };
    return {
      time: false,
      range: (u, low, high) => {
        const more = 0.05 * (high - low) || 0.05 * Math.abs(low) || 1;
        return [low - more, high + more];
      },
    };
  }

  paint(u, seriesIdx, members) {
    uPlot.orient(u, seriesIdx, (series, dataX, dataY, scaleX, scaleY, toX, toY, left, top, wide, high) => {
      const [xs, ys] = u.data[seriesIdx],
        { ctx } = u,
        r = 3.6 * devicePixelRatio,
        color = series.stroke();
      const at = xs.map((x, k) => [toX(x, scaleX, wide, left), toY(ys[k], scaleY, high, top)]);
      ctx.save();
      ctx.beginPath();
      ctx.rect(left, top, wide, high);
      ctx.clip();
      if (this.joined) {
        ctx.beginPath();
        at.forEach(([x, y], k) => (k === 0 ? ctx.moveTo(x, y) : ctx.lineTo(x, y)));
        ctx.strokeStyle = color;
        ctx.lineWidth = 1.2 * devicePixelRatio;
        ctx.stroke();
      }
      const tint = this.tints(members, color),
        cell = this.cellOf(u, at);
      at.forEach(([x, y], k) => {
        ctx.fillStyle = tint(k);
        ctx.beginPath();
        if (cell) ctx.rect(x - cell[0] / 2, y - cell[1] / 2, ...cell);
        else ctx.arc(x, y, r, 0, 2 * Math.PI);
        ctx.fill();
      });
      ctx.restore();
    });
    return null;
  }

  // The colour of the k-th member.
  tints(members, group) {
    if (this.color < 0) return () => group;
    const values = this.table.columns[this.color].numbers;
    let low = Infinity,
      high = -Infinity;
    for (const i of this.seen) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
    return (k) =>
      Number.isFinite(values[members[k]]) ? shade((values[members[k]] - low) / (high - low || 1)) : theme.is.ground;
  }

  nearest(e) {
    const { columns } = this.table,
      box = this.plot.over.getBoundingClientRect();
    const px = e.clientX - box.left,
      py = e.clientY - box.top;
    let best = this.picked,
      least = NEAR;
    for (const i of this.seen) {
      const d = Math.hypot(
        this.plot.valToPos(columns[this.x].numbers[i], 'x') - px,
        this.plot.valToPos(columns[this.y].numbers[i], 'y') - py,
      );
      if (d < least) [best, least] = [i, d];
    }
    return best;
  }

  // All cells of one run beside the plot.
  pick(i) {
    this.picked = i;
    if (this.ring) this.ring.hidden = !this.seen?.includes(i);
    const holder = $('points-row');
    if (i < 0) {
      holder.textContent = 'Move over a point, or click a row of the table, to see its run.';
      return;
    }
    const { columns } = this.table;
    if (this.plot && this.seen.includes(i))
      this.ring.style.transform = `translate(${this.plot.valToPos(columns[this.x].numbers[i], 'x')}px, ${this.plot.valToPos(columns[this.y].numbers[i], 'y')}px)`;
    const t = document.createElement('table');
    for (const c of columns) {
      if (c.texts[i] === '') continue;
      const row = t.insertRow(),
        head = document.createElement('th');
      head.scope = 'row';
      head.textContent = c.title;
      row.append(head);
      row.insertCell().textContent = c.texts[i];
    }
    holder.replaceChildren(t);
  }
}

export function showPoints(data) {
  for (const id of ['main', 'tools']) $(id).hidden = true;
  $('points').hidden = false;
  $('heading').textContent = data.text.title || 'lockstep report';
  globalThis.lockstepReport = { data, points: new Points(data) };
}
