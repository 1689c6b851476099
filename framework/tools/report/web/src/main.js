// SPDX-License-Identifier: BSD-3-Clause
// The page: a run, many runs as points, or modes.
import { readData } from './data.js';
import { askedRun, keptRun, showHistory } from './histories.js';
import { showModes } from './modes.js';
import { showPoints } from './points.js';
import { showRun } from './run.js';

const data = readData();
if (data.kind === 'points') {
  const run = location.hash !== '#runs' && keptRun(data, askedRun() || data.shown);
  if (run) showHistory(data, run);
  else showPoints(data);
  // Another run is another page.
  addEventListener('hashchange', () => location.reload());
} else if (data.kind === 'modes') showModes(data);
else showRun(data);
