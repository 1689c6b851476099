// The page: data, world, and what shows and moves it.
import { Against } from './against.js';
import { Clock } from './clock.js';
import { readData } from './data.js';
import { addKeys } from './keys.js';
import { Motion } from './motion.js';
import { Panel } from './panel.js';
import { Plots } from './plots.js';
import { Stage } from './stage.js';
import { theme } from './theme.js';
import { Timebar } from './timebar.js';
import { addTabs } from './tabs.js';
import { World } from './world.js';
import { download } from './export.js';

const elements = Object.fromEntries([...document.querySelectorAll('[id]')].map((e) => [e.id, e]));

const data = readData();
const motion = new Motion(data);
const clock = new Clock(data.frames.times);
const world = new World(data, motion);
elements.heading.textContent = data.text.title || 'lockstep report';

let stage = null;
try {
  stage = new Stage(data, world, elements);
} catch (error) {
  elements.failure.hidden = false;
  elements.failure.textContent = `This browser cannot draw in space: ${error.message}. Plots and numbers are there all the same.`;
}

const plots = new Plots(data, clock, elements.plots);
new Against(data, clock, elements.against);
new Timebar(data, clock, elements);

let selected = -1, following = false;
const options = { centers: false };

function press(button, on) { button.setAttribute('aria-pressed', String(on)); }

function showOptions() {
  world.bodies.showCenters(options.centers, selected);
  press(elements.centers, options.centers);
  press(elements.forces, world.arrows.shown.force);
  press(elements.reactions, world.arrows.shown.reaction);
  press(elements.trails, world.trails.shown);
  if (stage) {
    press(elements.names, stage.overlay.names.bodies);
    press(elements.joints, stage.overlay.names.links);
    press(elements.parallel, stage.views.isOrthographic);
  }
  press(elements.follow, following);
  elements.follow.disabled = selected < 0;
  elements.trail.disabled = selected < 0;
  press(elements.trail, world.trails.lines.has(`body ${selected}`));
  world.seek(clock.t);
  stage?.redraw();
}

const actions = {
  toggle: () => clock.toggle(),
  step: (n) => clock.step(n),
  first: () => clock.seek(clock.start),
  last: () => clock.seek(clock.end),
  fit: () => stage?.views.fit(),
  look: (view) => stage?.views.look(view),
  orthographic() {
    stage?.views.use(!stage.views.isOrthographic);
    showOptions();
  },
  names() {
    if (stage) stage.overlay.names.bodies = !stage.overlay.names.bodies;
    showOptions();
  },
  loop() {
    clock.loop = !clock.loop;
    clock.tell('state');
  },
  select(index) {
    selected = index;
    if (index < 0) following = false;
    world.bodies.select(index);
    panel.showBody(index);
    stage?.views.follow(following ? world.bodies.groups[index] : null);
    showOptions();
  },
};

const panel = new Panel(data, world, actions, elements);
const showTab = addTabs(elements.tabs);
addKeys(actions);

elements.fit.addEventListener('click', actions.fit);
elements.view.addEventListener('change', () => {
  actions.look(elements.view.value);
  elements.view.value = '';
});
elements.parallel.addEventListener('click', actions.orthographic);
elements.names.addEventListener('click', actions.names);
elements.joints.addEventListener('click', () => {
  if (stage) stage.overlay.names.links = !stage.overlay.names.links;
  showOptions();
});
elements.centers.addEventListener('click', () => {
  options.centers = !options.centers;
  showOptions();
});
for (const [id, kind] of [['forces', 'force'], ['reactions', 'reaction']]) {
  elements[id].hidden = !data.mechanism.loads.some((load) => load.reaction === (kind === 'reaction'));
  elements[id].addEventListener('click', () => {
    world.arrows.shown[kind] = !world.arrows.shown[kind];
    showOptions();
  });
}
elements.trails.addEventListener('click', () => {
  world.trails.show(!world.trails.shown);
  showOptions();
});
elements.follow.addEventListener('click', () => {
  following = !following;
  stage?.views.follow(following ? world.bodies.groups[selected] : null);
  showOptions();
});
elements.trail.addEventListener('click', () => {
  const key = `body ${selected}`;
  if (world.trails.lines.has(key)) world.trails.remove(key);
  else world.addBodyTrail(selected);
  showOptions();
});
elements.picture.addEventListener('click', async () => {
  if (!stage) return;
  const bytes = await new Promise((done) => {
    stage.render();
    elements.canvas.toBlob(done);
  });
  download(`${plots.fileName()}.png`, bytes);
});
elements.csv.addEventListener('click', () => plots.saveCsv());

// A click picks a body; a drag turns the view.
let down = null;
elements.canvas.addEventListener('pointerdown', (e) => { down = [e.clientX, e.clientY]; });
elements.canvas.addEventListener('pointerup', (e) => {
  if (!stage || !down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 4) return;
  const box = elements.canvas.getBoundingClientRect();
  const body = stage.pick(e.clientX - box.left, e.clientY - box.top);
  actions.select(body);
  if (body >= 0) showTab('bodies-tab');
});

clock.addEventListener('time', () => {
  world.seek(clock.t);
  panel.showTime();
  stage?.redraw();
});

function recolor() {
  stage?.recolor();
  panel.recolor();
  plots.build();
}
theme.onChange(recolor);
showOptions();

// "#t=0.5" opens at an instant; otherwise the run is shown from its start, unless the reader wants no motion.
const asked = /^#t=([-+.e\d]+)$/i.exec(location.hash);
if (asked && Number.isFinite(Number(asked[1]))) clock.seek(Number(asked[1]));
else if (!matchMedia('(prefers-reduced-motion: reduce)').matches) clock.play();

// For tests and for the curious.
globalThis.lockstepReport = { data, clock, motion, world, stage, plots, actions };
