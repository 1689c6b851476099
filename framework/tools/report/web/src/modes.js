// SPDX-License-Identifier: BSD-3-Clause
// Modes: the mechanism swings about its rest in the shape that is chosen; it takes two seconds, whatever the frequency.
import { Quaternion, Vector3 } from 'three';
import { button, make, press, titledTable } from './dom.js';
import { number } from './plots.js';
import { RunPage } from './run.js';

const PERIOD = 2; // s of the reader's
const FRAMES = 64; // of a period

// The run that a mode makes: its frames are filled by Swing.
function runOf(data) {
  const { width } = data.frames,
    rest = data.frames.rows.slice(0, width);
  const times = Float64Array.from({ length: FRAMES + 1 }, (_, k) => (PERIOD * k) / FRAMES);
  return {
    ...data,
    rest,
    table: { rows: 0, stride: 1, columns: [{ name: 't', unit: 's', values: times }] },
    mechanism: { ...data.mechanism, loads: [] },
    frames: { ...data.frames, n: FRAMES + 1, times, rows: new Float32Array((FRAMES + 1) * width), jumps: [] },
  };
}

// Fills the frames with a mode: displacements of the origin of each slot and rotations about it, as
//   amplitude Re((a + i b) exp(i phase)),
// which is exact to first order; between them the body is moved as a rigid one.
function fillFrames(run, mode, amplitude) {
  const { rest, frames, pivots } = run,
    { width } = frames;
  const omega = (2 * Math.PI) / PERIOD;
  for (let k = 0; k <= FRAMES; ++k) {
    const phase = (2 * Math.PI * k) / FRAMES,
      [cosine, sine] = [Math.cos(phase), Math.sin(phase)];
    frames.rows.set(rest, k * width);
    mode.shape.forEach((z, i) => {
      const now = (c) => amplitude * (z[c] * cosine - z[6 + c] * sine),
        rate = (c) => -amplitude * omega * (z[c] * sine + z[6 + c] * cosine);
      const move = new Vector3(now(0), now(1), now(2)),
        turn = new Vector3(now(3), now(4), now(5)),
        w = new Vector3(rate(3), rate(4), rate(5));
      const at = 13 * i,
        x0 = new Vector3().fromArray(rest, at),
        q0 = new Quaternion(rest[at + 4], rest[at + 5], rest[at + 6], rest[at + 3]),
        pivot = new Vector3(...pivots[i]);
      const angle = turn.length(),
        q = new Quaternion().setFromAxisAngle(angle > 0 ? turn.clone().divideScalar(angle) : turn.set(1, 0, 0), angle);
      const arm = x0.sub(pivot).applyQuaternion(q);
      const x = arm.clone().add(pivot).add(move);
      const v = new Vector3(rate(0), rate(1), rate(2)).add(w.clone().cross(arm));
      q.multiply(q0);
      frames.rows.set([...x, q.w, q.x, q.y, q.z, ...v, ...w], k * width + at);
    });
  }
}

export class ModesPage extends RunPage {
  constructor(data) {
    const run = runOf(data);
    run.clockWords = (t) => `${Math.round((360 * t) / PERIOD) % 360}\u00b0`;
    if (data.modes.length > 0) fillFrames(run, data.modes[0], 0.2);
    else run.frames.times.forEach((_, k) => run.frames.rows.set(run.rest, k * run.frames.width));
    super(run);
    this.mode = 0;
    this.amplitude = 0.2;
    const { elements } = this;
    elements['mode-words'].textContent = 'The mechanism has no degree of freedom and no modes.';
    elements['modes-bar'].hidden = false;
    elements['plots-tab'].textContent = 'Modes';
    for (const part of elements['plots-panel'].children) part.hidden = part !== elements['modes-list'];
    data.modes.forEach((mode, k) => elements.mode.add(new Option(mode.name, k)));
    elements.mode.addEventListener('change', () => this.choose(Number(elements.mode.value)));
    elements.amplitude.addEventListener('input', () => {
      this.amplitude = 10 ** Number(elements.amplitude.value);
      this.swing();
    });
    elements.amplitude.value = Math.log10(this.amplitude);
    this.addTable();
    this.choose(0);
  }

  addTable() {
    const table = titledTable(['mode', 'frequency', 'damping', ''], { className: 'modes-table' });
    const body = table.createTBody();
    this.rows = this.data.modes.map((mode, k) => {
      const row = body.insertRow(),
        chooser = button(mode.name, () => this.choose(k));
      row.insertCell().append(chooser);
      const facts = mode.frequency > 0 ? [`${number(mode.frequency)} Hz`, number(mode.damping)] : ['\u2013', '\u2013'];
      row.append(...[...facts, mode.words].map((words) => make('td', words)));
      return { row, chooser };
    });
    this.elements['modes-list'].append(table);
  }

  choose(k) {
    const mode = this.data.modes[k];
    if (!mode) return;
    this.mode = k;
    this.elements.mode.value = k;
    this.rows.forEach(({ row, chooser }, i) => {
      row.className = i === k ? 'picked' : '';
      press(chooser, i === k);
    });
    this.swing();
  }

  // The frames of the mode at its amplitude, and what is drawn from them.
  swing() {
    const mode = this.data.modes[this.mode];
    if (!mode) return;
    fillFrames(this.data, mode, this.amplitude);
    const { elements, amplitude, data, motion, world, clock } = this;
    elements['mode-words'].textContent = mode.words;
    elements['amplitude-words'].textContent = `${number(amplitude)} rad, ${number(amplitude * data.length)} m`;
    elements.amplitude.setAttribute('aria-valuetext', elements['amplitude-words'].textContent);
    motion.t = NaN;
    world.trails.redo();
    clock.seek(clock.t);
  }

  // A step is a sixteenth of a swing.
  step(n) {
    this.clock.step((n * FRAMES) / 16);
  }
}
