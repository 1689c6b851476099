// SPDX-License-Identifier: BSD-3-Clause
// Clock: the one time of the page, which the scene and the plots share.

import { indexAt } from './motion.js';

export const SPEEDS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];

// Real time for runs of a few seconds; otherwise the speed that shows the run in about ten.
function speedFor(duration) {
  if (duration >= 2 && duration <= 30) return 1;
  const wanted = Math.log(Math.max(duration, 1e-9) / 8);
  return SPEEDS.reduce((best, s) => (Math.abs(Math.log(s) - wanted) < Math.abs(Math.log(best) - wanted) ? s : best));
}

export class Clock extends EventTarget {
  constructor(times) {
    super();
    this.instants = Float64Array.from(new Set(times)); // a jump has two frames
    this.start = times[0];
    this.end = times[times.length - 1];
    this.t = this.start;
    this.playing = false;
    this.loop = true;
    this.speed = speedFor(this.end - this.start);
    this.last = 0;
  }

  tell(what) {
    this.dispatchEvent(new Event(what));
  }

  seek(t) {
    this.t = Math.min(this.end, Math.max(this.start, t));
    this.tell('time');
  }

  stopAt(t) {
    this.pause();
    this.seek(t);
  }

  // By n frames: the instants that the run recorded.
  step(n) {
    const { instants } = this;
    let k = indexAt(instants, this.t);
    if (n > 0) k = Math.min(instants.length - 1, k + n);
    else k = Math.max(0, instants[k] < this.t ? k + n + 1 : k + n);
    this.stopAt(instants[k]);
  }

  play() {
    if (this.playing || this.end <= this.start) return;
    if (this.t >= this.end) this.t = this.start;
    this.playing = true;
    this.last = performance.now();
    this.tell('state');
    requestAnimationFrame((now) => this.tick(now));
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.tell('state');
  }

  toggle() {
    this.playing ? this.pause() : this.play();
  }

  tick(now) {
    if (!this.playing) return;
    const passed = Math.min(0.1, Math.max(0, now - this.last) / 1000);
    this.last = now;
    let t = this.t + passed * this.speed;
    if (t >= this.end) {
      if (this.loop) t = this.start;
      else {
        this.pause();
        t = this.end;
      }
    }
    this.seek(t);
    if (this.playing) requestAnimationFrame((later) => this.tick(later));
  }

  setSpeed(speed) {
    this.speed = speed;
    this.tell('state');
  }
}
