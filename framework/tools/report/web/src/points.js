// SPDX-License-Identifier: BSD-3-Clause
// The page of many runs: each is a point of a plot whose axes and colour are columns of their table.
import { readTable } from './csv.js';
import { button, byId as $, factsTable, make, press, titledTable, toggles } from './dom.js';
import { pngOf, saveCsv } from './export.js';
import { keptRun } from './histories.js';
import { extentOf, shade, varies } from './marks.js';
import { number } from './plots.js';
import { Scatter } from './scatter.js';
import { theme } from './theme.js';

const REASONS = ['failure', 'status']; // columns with the reason of a failure
const MOST_ROWS = 1000; // shown as a table
const MOST_GROUPS = 12; // with a button each

// The columns of texts that distinguish runs.
function wordsOf({ columns }) {
  return columns.filter((c) => !c.numbers && !REASONS.includes(c.title) && new Set(c.texts).size > 1);
}

// Rows by all words of these columns: each group is a line.
function groupsOf({ rows }, words) {
  const groups = new Map();
  rows.forEach((_, i) => {
    const given = words.map((c) => c.texts[i]).filter((t) => t !== '');
    const name = given.join(', ') || 'runs';
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(i);
  });
  return [...groups].map(([name, members]) => ({ name, members }));
}

const NOTHING = 1e-10; // in any SI unit

class Points {
  constructor(data) {
    this.data = data;
    this.table = readTable(data.csv);
    this.words = wordsOf(this.table);
    this.groups = groupsOf(this.table, this.words);
    this.numeric = this.table.columns.map((c, i) => (c.numbers ? i : -1)).filter((i) => i >= 0);
    this.x = this.find(data.x, 0);
    this.y = this.varying(this.find(data.y, 1));
    this.color = this.table.columns.findIndex((c) => c.title === data.color && c.numbers); // -1: by group
    this.by = this.groups.length > MOST_GROUPS || this.words.length === 1 ? 0 : -1; // what has one colour and one button
    this.hidden = new Set();
    this.log = { x: data.log, y: data.log };
    this.joined = data.joined;
    this.picked = -1;
    this.scatter = new Scatter($('points-plot'), this.pick.bind(this), this.open.bind(this));
    this.restore();
    this.addChoices();
    this.addToggles();
    this.addGroups();
    this.addTable();
    this.addAbout();
    new ResizeObserver(() => this.draw()).observe($('points-plot'));
    theme.onChange(() => this.draw());
  }

  // The column of numbers with this title, else the n-th one of numbers; -1: none.
  find(title, n) {
    const i = this.table.columns.findIndex((c) => c.title === title && c.numbers);
    return i >= 0 ? i : (this.numeric[Math.min(n, this.numeric.length - 1)] ?? -1);
  }

  // This column; of the results of a sweep, the least or greatest values, whichever vary more, of the first that varies.
  varying(i) {
    const { columns } = this.table;
    const spread = (k) => {
      const numbers = columns[k]?.numbers ?? [];
      const [low, high] = extentOf(numbers, numbers.keys());
      return varies(low, high) && high - low > NOTHING ? high - low : 0;
    };
    const results = this.numeric.filter((k) => k >= i && !this.data.shown && columns[k + 1]?.title.includes(' min'));
    return results.map((k) => (spread(k + 1) < spread(k + 2) ? k + 2 : k + 1)).find(spread) ?? i;
  }

  addChoices() {
    const ways = this.words.map((c, k) => [`by ${c.title}`, k]);
    ways.push([this.groups.length > 1 ? 'by all texts' : 'none', -1]);
    for (const key of ['x', 'y', 'color']) {
      const select = $(`points-${key}`);
      if (key === 'color') for (const [name, k] of ways) select.add(new Option(name.slice(0, 80), `by ${k}`));
      for (const i of this.numeric) select.add(new Option(this.table.columns[i].title.slice(0, 80), i));
      select.value = key === 'color' && this.color < 0 ? `by ${this.by}` : this[key];
      select.addEventListener('change', () => this.choose(key, select.value));
    }
  }

  choose(key, value) {
    if (value.startsWith('by ')) {
      this.color = -1;
      this.by = Number(value.slice(3));
      this.hidden.clear();
      this.addGroups();
    } else this[key] = Number(value);
    this.keep();
    this.draw();
  }

  // What the reader chose stays when he comes back from a run, where the browser lets a page keep something.
  keep() {
    const { x, y, color, by, log, joined } = this;
    try {
      sessionStorage.setItem(this.place, JSON.stringify({ x, y, color, by, log, joined }));
    } catch {
      return; // then the page opens as it did at first
    }
  }

  restore() {
    let kept = null;
    try {
      kept = JSON.parse(sessionStorage.getItem(this.place));
    } catch {
      return;
    }
    const { columns } = this.table;
    if (kept && [kept.x, kept.y].every((i) => columns[i]?.numbers) && this.data.histories) Object.assign(this, kept);
  }

  // Another file of the same name is another page.
  get place() {
    return `lockstep ${location.pathname} ${this.table.columns.map((c) => c.title)}`;
  }

  // The number of the run of a row, if the page keeps it; NaN.
  runOf(i) {
    const { columns } = this.table;
    const run = columns[0].title === 'run' ? Number(columns[0].texts[i]) : NaN;
    return keptRun(this.data, run) ? run : NaN;
  }

  open(i) {
    const run = this.runOf(i);
    if (run >= 0) location.hash = `run=${run}`;
  }

  linkTo(i, words) {
    return make('a', words, { href: `#run=${this.runOf(i)}` });
  }

  addToggles() {
    const changed = () => {
      this.keep();
      this.draw();
    };
    toggles($('points-log-x'), this.log, 'x', changed);
    toggles($('points-log-y'), this.log, 'y', changed);
    toggles($('points-join'), this, 'joined', changed);
    $('points-png').addEventListener('click', () => this.scatter.plot && pngOf(this.scatter.plot, 'runs.png'));
    $('points-csv').addEventListener('click', () => saveCsv('runs.csv', this.data.csv));
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
      const b = button(name.slice(0, 80) || 'none', () => {
        this.hidden[this.hidden.has(name) ? 'delete' : 'add'](name);
        press(b, !this.hidden.has(name));
        this.draw();
      });
      b.style.setProperty('--tint', theme.color(i));
      press(b, true);
      $('points-groups').append(b);
    });
  }

  addTable() {
    const t = titledTable(this.table.columns.map((c) => c.title));
    const body = t.createTBody();
    this.table.rows.slice(0, MOST_ROWS).forEach((cells, i) => {
      const row = body.insertRow();
      for (const cell of cells) row.insertCell().textContent = cell;
      if (this.runOf(i) >= 0) row.cells[0].replaceChildren(this.linkTo(i, cells[0]));
      row.addEventListener('click', () => this.pick(i));
    });
    $('points-table').append(t);
    const n = this.table.rows.length;
    if (n > MOST_ROWS) $('points-table').append(`The first ${MOST_ROWS} of ${n} rows; the CSV has all.`);
  }

  addAbout() {
    const { text } = this.data;
    const about = [make('p', text.description), ...text.facts.map((fact) => make('p', fact.join(' ')))];
    about.push(make('p', `lockstep ${text.version}, on ${text.machine}`), make('pre', text.command), make('pre', text.scene));
    $('points-about').append(...about.filter((e) => e.textContent !== ''));
  }

  draw() {
    if ($('points-plot').clientWidth === 0 || this.x < 0 || this.y < 0) return;
    const { columns } = this.table;
    const shown = this.groups.filter((g) => !this.hidden.has(this.nameOf(g)));
    this.scatter.draw({
      x: { ...columns[this.x], log: this.log.x },
      y: { ...columns[this.y], log: this.log.y },
      groups: shown.map((g) => ({ ...g, color: theme.color(this.names.indexOf(this.nameOf(g))) })),
      colors: this.color < 0 ? null : columns[this.color],
      joined: this.joined,
    });
    this.showMissing(shown);
    this.showScale();
    queueMicrotask(() => this.pick(this.picked)); // uPlot knows its scales by then
  }

  showMissing(shown) {
    const n = shown.reduce((sum, g) => sum + g.members.length, 0) - this.scatter.seen.length;
    const runs = n === 1 ? '1 run has' : `${n} runs have`;
    const words = `${runs} no point here: failed, without this number, or far outside the plot; the table lists them.`;
    $('points-note').textContent = n > 0 ? words : '';
  }

  // What the colours of numbers mean.
  showScale() {
    const holder = $('points-scale');
    holder.hidden = this.color < 0;
    if (this.color < 0) return;
    const [low, high] = this.scatter.extent;
    const bar = make('i');
    bar.style.background = `linear-gradient(to right, ${[0, 0.25, 0.5, 0.75, 1].map(shade).join()})`;
    const title = this.table.columns[this.color].title.slice(0, 80);
    holder.replaceChildren(`${title}: ${number(low)} `, bar, ` ${number(high)}`);
  }

  // All cells of one run, next to the plot.
  pick(i) {
    this.picked = i;
    this.scatter.mark(i);
    const holder = $('points-row');
    if (i < 0) {
      holder.textContent = this.data.histories
        ? 'Point at a run to see its numbers; click it to see its curves and its motion.'
        : 'Point at a run, or click a row of the table, to see its numbers.';
      return;
    }
    const given = this.table.columns.filter((c) => c.texts[i] !== '');
    holder.replaceChildren(factsTable(given.map((c) => [c.title, c.texts[i]])));
    const run = this.runOf(i);
    if (run >= 0) holder.prepend(this.linkTo(i, `Show run ${run}: its curves and its motion`));
  }
}

export function pointsPage(data) {
  for (const id of ['main', 'tools']) $(id).hidden = true;
  $('points').hidden = false;
  $('heading').textContent = data.text.title || 'lockstep report';
  return { data, points: new Points(data) };
}
