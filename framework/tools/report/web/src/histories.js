// SPDX-License-Identifier: BSD-3-Clause
// Runs of a sweep that the page keeps: one of them is shown as a run, after "#run=7".
import { addBefore } from './before.js';
import { readTable } from './csv.js';
import { RunPage } from './run.js';

// The number that the address asks for; NaN: none.
export function askedRun() {
  const asked = /(?:^#|&)run=(\d+)/.exec(location.hash);
  return asked ? Number(asked[1]) : NaN;
}

export function keptRun(data, number) {
  return data.histories?.runs.find((run) => run.run === number);
}

const nothing = {
  ...{ bodies: [], markers: [], links: [], forces: [], loads: [], moving: [], moved_markers: [] },
  ...{ gravity: [0, 0, 0], plane: -1, length: 1 },
};

// The data of a page that shows this run.
function pageOf(data, run) {
  const { columns, rows } = readTable(data.csv);
  const own = rows.find((_, i) => columns[0].texts[i] === String(run.run)) ?? [];
  const facts = columns.map((c, k) => [c.title, own[k] ?? '']).filter(([, text]) => text !== '');
  const warnings = facts.filter(([title, status]) => title === 'status' && status.startsWith('failed'));
  return {
    text: { ...data.text, title: `${data.text.title}, run ${run.run}`, facts, warnings: warnings.map((fact) => fact[1]) },
    mechanism: data.histories.mechanisms[run.mechanism] ?? nothing,
    meshes: data.histories.meshes,
    frames: run.frames ?? { n: 0, width: 0, times: run.table.columns[0].values, rows: new Float32Array(0), jumps: [] },
    table: run.table,
    marks: run.marks ?? [],
    switches: run.switches ?? { at_start: [], later: [] },
  };
}

// After a search, with the first run before it.
export function historyPage(data, run) {
  const own = pageOf(data, run),
    [first] = data.histories.runs;
  if (data.shown && run !== first) addBefore(own, pageOf(data, first));
  const page = new RunPage(own);
  page.elements.back_to_runs.hidden = false;
  if (run.mechanism === undefined)
    page.fail('The motion of this run was not kept; its columns are available.');
  return page;
}
