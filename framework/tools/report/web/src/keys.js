// SPDX-License-Identifier: BSD-3-Clause
// Keys of the page, besides those of its buttons.

const EIGHTH = Math.PI / 16; // of a right angle

export function addKeys(page) {
  addEventListener('keydown', (e) => {
    if (e.ctrlKey || e.altKey || e.metaKey || e.target.closest?.('select, textarea, input:not(#slider)')) return;
    const onButton = e.target.closest('button, summary') !== null;
    const act = {
      ' ': () => !onButton && page.clock.toggle(),
      ArrowLeft: () => page.step(e.shiftKey ? -10 : -1),
      ArrowRight: () => page.step(e.shiftKey ? 10 : 1),
      Home: () => page.clock.seek(page.clock.start),
      End: () => page.clock.seek(page.clock.end),
      f: () => page.views?.fit(),
      1: () => page.views?.look('iso'),
      2: () => page.views?.look('front'),
      3: () => page.views?.look('right'),
      4: () => page.views?.look('top'),
      a: () => page.views?.turn(-EIGHTH, 0),
      d: () => page.views?.turn(EIGHTH, 0),
      w: () => page.views?.turn(0, EIGHTH),
      s: () => page.views?.turn(0, -EIGHTH),
      A: () => page.views?.pan(-0.1, 0),
      D: () => page.views?.pan(0.1, 0),
      W: () => page.views?.pan(0, 0.1),
      S: () => page.views?.pan(0, -0.1),
      '+': () => page.views?.zoom(1.2),
      '-': () => page.views?.zoom(1 / 1.2),
      o: () => page.orthographic(),
      n: () => page.elements.names.click(),
      l: () => page.elements.loop.click(),
      Escape: () => page.select(-1),
    }[e.key];
    if (!act || (e.target.getAttribute?.('role') === 'tab' && e.key.startsWith('Arrow'))) return;
    if (act() !== false) e.preventDefault();
  });
}
