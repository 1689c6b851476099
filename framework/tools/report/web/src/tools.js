// SPDX-License-Identifier: BSD-3-Clause
// The buttons above the picture, and those for the selected body.
import { press, toggles } from './dom.js';
import { download } from './export.js';

export class Tools {
  constructor(page) {
    this.page = page;
    this.centers = false;
    const { elements, world, stage, plots, data } = page;
    const on = (id, act) => elements[id].addEventListener('click', act);
    on('fit', () => page.views?.fit());
    on('parallel', () => page.orthographic());
    on('follow', () => page.follow(!page.following));
    on('trail', () => page.trail());
    on('csv', () => plots.saveCsv());
    on('picture', () => this.savePicture());
    const flips = (id, object, key) => toggles(elements[id], object, key, () => this.show());
    const names = stage?.overlay.names ?? { bodies: false, links: false };
    flips('names', names, 'bodies');
    flips('joints', names, 'links');
    flips('centers', this, 'centers');
    flips('trails', world.trails, 'shown');
    flips('forces', world.arrows.shown, 'force');
    flips('reactions', world.arrows.shown, 'reaction');
    elements.forces.hidden = !data.mechanism.loads.some((load) => !load.reaction);
    elements.reactions.hidden = !data.mechanism.loads.some((load) => load.reaction);
    elements.arrows.parentElement.hidden = data.mechanism.loads.length === 0;
    elements.arrows.addEventListener('input', () => {
      world.arrows.factor = 10 ** Number(elements.arrows.value);
      this.show();
    });
    elements.view.addEventListener('change', () => {
      page.views?.look(elements.view.value);
      elements.view.value = '';
    });
  }

  // Buttons as things are, and the picture with them.
  show() {
    const { elements, world, stage, selected, following, clock } = this.page;
    world.bodies.showCenters(this.centers, selected);
    press(elements.parallel, stage?.views.isOrthographic ?? false);
    press(elements.follow, following);
    press(elements.trail, world.trails.lines.has(`body ${selected}`));
    elements.follow.disabled = elements.trail.disabled = selected < 0;
    world.seek(clock.t);
    stage?.redraw();
  }

  savePicture() {
    const { stage, plots } = this.page;
    if (!stage) return;
    stage.render();
    stage.elements.canvas.toBlob((bytes) => download(`${plots.fileName()}.png`, bytes));
  }
}
