// SPDX-License-Identifier: BSD-3-Clause
// The extremes of the motion: of each column the least and the greatest value, and when.
import { button, make, titledTable } from './dom.js';
import { number, titleOf } from './plots.js';

const ROUNDING = 1e-9; // of the largest number of a unit

export function showExtremes({ table }, clock, holder) {
  const columns = table.columns.filter((c) => c.range);
  holder.hidden = columns.length === 0;
  const largest = new Map();
  for (const { unit, range } of columns)
    largest.set(unit, Math.max(largest.get(unit) ?? 0, Math.abs(range.least), Math.abs(range.most)));
  const rows = titledTable(['', 'least', 'at t [s]', 'greatest', 'at t [s]'], { className: 'extremes' });
  for (const column of columns) {
    const { least, t_least, most, t_most, resolved } = column.range;
    const [low, high] = [least, most].map((v) => number(Math.abs(v) <= ROUNDING * largest.get(column.unit) ? 0 : v));
    const row = rows.insertRow();
    row.append(make('th', titleOf(column), { scope: 'row' }));
    for (const [text, t] of [[resolved ? low : `at most ${low}`, t_least], [resolved ? high : `at least ${high}`, t_most]]) {
      row.append(make('td', text), make('td'));
      if (low !== high) row.lastChild.append(button(number(t), () => clock.stopAt(t), { title: 'Go to this time' }));
    }
  }
  holder.append(rows);
}
