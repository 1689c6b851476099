// SPDX-License-Identifier: BSD-3-Clause
// Keys of the page, besides those of its buttons.

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
      f: () => page.fit(),
      1: () => page.look('iso'),
      2: () => page.look('front'),
      3: () => page.look('right'),
      4: () => page.look('top'),
      a: () => page.turn(-1, 0),
      d: () => page.turn(1, 0),
      w: () => page.turn(0, 1),
      s: () => page.turn(0, -1),
      A: () => page.pan(-1, 0),
      D: () => page.pan(1, 0),
      W: () => page.pan(0, 1),
      S: () => page.pan(0, -1),
      '+': () => page.zoom(1.2),
      '-': () => page.zoom(1 / 1.2),
      o: () => page.orthographic(),
      n: () => page.names(),
      l: () => page.clock.switchLoop(),
      Escape: () => page.select(-1),
    }[e.key];
    if (!act || (e.target.getAttribute?.('role') === 'tab' && e.key.startsWith('Arrow'))) return;
    if (act() !== false) e.preventDefault();
  });
}
