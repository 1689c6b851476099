// SPDX-License-Identifier: BSD-3-Clause
// The run before a search: its numbers, curves and bodies next to those of the run that is shown.
import { Group } from 'three';
import { Bodies } from './bodies.js';
import { byId, factsTable } from './dom.js';
import { Motion } from './motion.js';
import { number } from './plots.js';
import { slopesOf, valueAt } from './slopes.js';

// Adds the run before to a page that is not yet shown, its columns at the times of the others; NaN after its end.
export function addBefore(data, before) {
  const [{ values, curve }] = data.table.columns,
    end = before.table.columns[0].values.at(-1);
  const other = before.table.columns.slice(1).map(({ name, unit }, k) => {
    const slopes = slopesOf(before, k + 1);
    const at = (times) => times?.map((t) => (t > end ? NaN : valueAt(before, slopes, k + 1, t)));
    return { name: `${name} before`, unit, values: at(values), curve: at(curve), before: true };
  });
  Object.assign(data, { before, table: { ...data.table, columns: [...data.table.columns, ...other] } });
  byId('plots-panel').prepend(numbersOfBoth(data));
}

// What both runs have at their ends, by the words of formulas alone.
function numbersOfBoth({ text, before }) {
  const was = new Map(before.text.facts),
    short = (words) => (isNaN(words) ? words : number(Number(words)));
  const rows = text.facts.filter(([title]) => !/ (min|max)( \[.*)?$/.test(title));
  const named = (title) => title.replace(/^--\S+ | final(?=( \[.*)?$)/g, '');
  return factsTable([['', 'before', 'after'], ...rows.map(([t, now]) => [named(t), short(was.get(t)), short(now)])]);
}

// Adds the bodies, grey and transparent; a function that moves them.
export function addBodiesBefore(data, { root, frame, unit }) {
  const looks = data.mechanism.bodies.map((body) => ({ ...body, look: { color: 'gray', opacity: 0.25 } }));
  const bodies = new Bodies({ ...data, mechanism: { ...data.mechanism, bodies: looks } }, new Group()),
    motion = new Motion(data);
  bodies.dress(frame, unit);
  root.add(...bodies.moving);
  return (t) => (motion.seek(t), bodies.seek(motion));
}
