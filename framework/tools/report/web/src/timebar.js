// SPDX-License-Identifier: BSD-3-Clause
// The bar of time: play, step, scrub, speed, loop; events and impacts as marks.
import { SPEEDS } from './clock.js';
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
    loop.addEventListener('click', () => {
      clock.loop = !clock.loop;
      clock.tell('state');
    });
    slider.max = TICKS;
    slider.addEventListener('input', () => {
      clock.pause();
      clock.seek(clock.start + (slider.value / TICKS) * (clock.end - clock.start));
    });
    // Arrow keys on the slider step by frames, as everywhere on the page.
    slider.addEventListener(
      'keydown',
      (e) => ['ArrowLeft', 'ArrowRight', 'Home', 'End'].includes(e.key) && e.preventDefault(),
    );
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
      const element = document.createElement('button');
      element.type = 'button';
      element.tabIndex = marks.length > 20 ? -1 : 0;
      element.className = mark.what.includes('impact') ? 'mark impact' : 'mark';
      element.style.left = `${length > 0 ? (100 * (mark.t - clock.start)) / length : 0}%`;
      element.title = `${mark.what} at ${number(mark.t)} s`;
      element.setAttribute('aria-label', element.title);
      element.addEventListener('click', () => {
        clock.pause();
        clock.seek(mark.t);
      });
      this.elements.marks.append(element);
    }
  }

  showTime() {
    const { clock, elements } = this,
      length = clock.end - clock.start;
    elements.slider.value = length > 0 ? (TICKS * (clock.t - clock.start)) / length : 0;
    if (this.data.clockWords) {
      const words = this.data.clockWords(clock.t);
      elements.slider.setAttribute('aria-valuetext', words);
      elements.time.textContent = words;
      return;
    }
    const digits = Math.max(0, Math.min(9, 3 - Math.floor(Math.log10(length || 1))));
    elements.slider.setAttribute('aria-valuetext', `${clock.t.toFixed(digits)} seconds`);
    elements.time.textContent = `${clock.t.toFixed(digits)} s`;
    elements.end.textContent = `/ ${number(clock.end)} s`;
  }

  showState() {
    const { clock, elements } = this;
    elements.play.textContent = clock.playing ? '\u275a\u275a' : '\u25b6';
    elements.play.setAttribute('aria-label', clock.playing ? 'Pause' : 'Play');
    elements.loop.setAttribute('aria-pressed', String(clock.loop));
    elements.speed.value = clock.speed;
  }
}
