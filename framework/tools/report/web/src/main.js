// The page: a run, or many runs as points.
import { readData } from './data.js';
import { showPoints } from './points.js';
import { showRun } from './run.js';

const data = readData();
if (data.kind === 'points') showPoints(data);
else showRun(data);
