// SPDX-License-Identifier: BSD-3-Clause
// The page: a run, many runs as points, or modes.
import { readData } from './data.js';
import { askedRun, historyPage, keptRun } from './histories.js';
import { ModesPage } from './modes.js';
import { pointsPage } from './points.js';
import { RunPage } from './run.js';

function pageOf(data) {
  if (data.kind === 'modes') return new ModesPage(data);
  if (data.kind !== 'points') return new RunPage(data);
  // Another run is another page.
  addEventListener('hashchange', () => location.reload());
  const run = location.hash !== '#runs' && keptRun(data, askedRun() || data.shown);
  return run ? historyPage(data, run) : pointsPage(data);
}

globalThis.lockstepReport = pageOf(readData()); // for tests and for the curious
