// SPDX-License-Identifier: BSD-3-Clause
// The page of a run: its parts, and what the reader may do with them.
import { Against } from './against.js';
import { Clock } from './clock.js';
import { whenClicked } from './dom.js';
import { showExtremes } from './extremes.js';
import { addKeys } from './keys.js';
import { Motion } from './motion.js';
import { isBad, Panel } from './panel.js';
import { Plots } from './plots.js';
import { Stage } from './stage.js';
import { addTabs } from './tabs.js';
import { theme } from './theme.js';
import { Timebar } from './timebar.js';
import { Tools } from './tools.js';
import { World } from './world.js';

export class RunPage {
  constructor(data) {
    this.data = data;
    this.elements = Object.fromEntries([...document.querySelectorAll('[id]')].map((e) => [e.id, e]));
    this.elements.heading.textContent = data.text.title || 'lockstep report';
    this.showChecks(data.text.facts.find(([name]) => name === 'checks')?.[1] ?? '');
    this.motion = new Motion(data);
    this.clock = new Clock(data.frames.times);
    this.world = new World(data, this.motion);
    this.selected = -1;
    this.following = false;
    this.stage = this.makeStage();
    this.plots = new Plots(data, this.clock, this.elements.plots);
    showExtremes(data, this.clock, this.elements.extremes);
    this.against = new Against(data, this.clock, this.elements.against);
    this.timebar = new Timebar(data, this.clock, this.elements);
    this.panel = new Panel(data, this.world, this, this.elements);
    this.showTab = addTabs(this.elements.tabs);
    this.tools = new Tools(this);
    addKeys(this);
    this.listen();
    this.tools.show();
    this.begin();
  }

  // "energy ok, constraints ok"; the numbers are in the tab of the run.
  showChecks(checks) {
    const words = checks.replace(/ \([^)]*\)/g, '').replace(/ {2,}/g, ', ');
    Object.assign(this.elements.checks, { textContent: words, title: checks, className: isBad(checks) ? 'bad' : '' });
  }

  get views() {
    return this.stage?.views;
  }

  // Where the browser cannot draw in space, plots and numbers are shown all the same.
  makeStage() {
    try {
      return new Stage(this.data, this.world, this.elements);
    } catch (error) {
      this.fail(`This browser cannot draw in 3-D: ${error.message}. Plots and numbers are still available.`);
      return null;
    }
  }

  fail(words) {
    Object.assign(this.elements.failure, { hidden: false, textContent: words });
  }

  listen() {
    this.clock.addEventListener('time', () => {
      this.world.seek(this.clock.t);
      this.panel.showTime();
      this.stage?.redraw();
    });
    theme.onChange(() => {
      this.stage?.recolor();
      this.panel.recolor();
      this.plots.build();
    });
    // A click picks a body; a drag turns the view.
    whenClicked(this.elements.canvas, (e) => {
      this.select(this.stage?.pick(e.offsetX, e.offsetY) ?? -1);
      if (this.selected >= 0) this.showTab('bodies-tab');
    });
  }

  // "#t=0.5" opens at a time; otherwise the run is played, unless the reader wants no motion.
  begin() {
    const asked = /(?:^#|&)t=([-+.e\d]+)$/i.exec(location.hash);
    if (asked && Number.isFinite(Number(asked[1]))) this.clock.seek(Number(asked[1]));
    else if (!matchMedia('(prefers-reduced-motion: reduce)').matches) this.clock.play();
  }

  // -- what keys and buttons do
  step(n) {
    this.clock.step(n);
  }

  orthographic() {
    this.views?.use(!this.views.isOrthographic);
    this.tools.show();
  }

  select(index) {
    this.selected = index;
    if (index < 0) this.following = false;
    this.world.bodies.select(index);
    this.panel.showBody(index);
    this.follow(this.following);
  }

  follow(on) {
    this.following = on;
    this.views?.follow(on ? this.world.bodies.groups[this.selected] : null);
    this.tools.show();
  }

  trail() {
    const key = `body ${this.selected}`;
    if (this.world.trails.lines.has(key)) this.world.trails.remove(key);
    else this.world.addBodyTrail(this.selected);
    this.tools.show();
  }
}
