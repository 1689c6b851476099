// SPDX-License-Identifier: BSD-3-Clause
// The bar of time: play, step, scrub, speed, loop; events and impacts as marks.
import { SPEEDS } from './clock.js';
import { button, toggles } from './dom.js';
import { number } from './plots.js';

const TICKS = 100000; // of the slider

export class Timebar {
  constructor(data, clock, elements) {
    Object.assign(this, { data, clock, elements });
    const { play, back, forward, first, slider, speed, loop } = elements;
    play.addEventListener('click', () => clock.toggle());
    back.addEventListener('click', () => clock.step(-1));
    forward.addEventListener('click', () => clock.step(1));
    first.addEventListener('click', () => clock.seek(clock.start));
    toggles(loop, clock, 'loop');
    slider.max = TICKS;
    const place = () => clock.start + (slider.value / TICKS) * (clock.end - clock.start);
    slider.addEventListener('input', () => clock.stopAt(place()));
    // Arrow keys on the slider step by frames, as everywhere on the page.
    const own = ['ArrowLeft', 'ArrowRight', 'Home', 'End'];
    slider.addEventListener('keydown', (e) => own.includes(e.key) && e.preventDefault());
    for (const s of SPEEDS) speed.add(new Option(`${s}\u00d7`, s));
    speed.addEventListener('change', () => clock.setSpeed(Number(speed.value)));
    clock.addEventListener('time', () => this.showTime());
    clock.addEventListener('state', () => this.showState());
    this.addMarks();
    this.showTime();
    this.showState();
  }

  addMarks() {
    const { clock, data } = this,
      length = clock.end - clock.start;
    const marks = data.marks.slice(0, 400);
    for (const mark of marks) {
      const element = button(undefined, () => clock.stopAt(mark.t), {
        tabIndex: marks.length > 20 ? -1 : 0,
        className: mark.what.includes('impact') ? 'mark impact' : 'mark',
        title: `${mark.what} at ${number(mark.t)} s`,
      });
      element.style.left = `${length > 0 ? (100 * (mark.t - clock.start)) / length : 0}%`;
      element.setAttribute('aria-label', element.title);
      this.elements.marks.append(element);
    }
  }

  showTime() {
    const { clock, elements } = this,
      length = clock.end - clock.start;
    elements.slider.value = length > 0 ? (TICKS * (clock.t - clock.start)) / length : 0;
    const digits = Math.max(0, Math.min(9, 3 - Math.floor(Math.log10(length || 1))));
    const words = this.data.clockWords?.(clock.t);
    elements.slider.setAttribute('aria-valuetext', words ?? `${clock.t.toFixed(digits)} seconds`);
    elements.time.textContent = words ?? `${clock.t.toFixed(digits)} s`;
    if (!words) elements.end.textContent = `/ ${number(clock.end)} s`;
  }

  showState() {
    const { clock, elements } = this;
    elements.play.textContent = clock.playing ? '\u275a\u275a' : '\u25b6';
    elements.play.setAttribute('aria-label', clock.playing ? 'Pause' : 'Play');
    elements.speed.value = clock.speed;
  }
}
