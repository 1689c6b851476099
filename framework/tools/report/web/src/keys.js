// Keys of the page, beside those of its buttons.

export function addKeys(actions) {
  addEventListener('keydown', (e) => {
    if (e.ctrlKey || e.altKey || e.metaKey || e.target.closest('select, textarea')) return;
    const onButton = e.target.closest('button, summary') !== null;
    const act = {
      ' ': () => !onButton && actions.toggle(),
      ArrowLeft: () => actions.step(e.shiftKey ? -10 : -1),
      ArrowRight: () => actions.step(e.shiftKey ? 10 : 1),
      Home: () => actions.first(),
      End: () => actions.last(),
      f: () => actions.fit(),
      1: () => actions.look('iso'),
      2: () => actions.look('front'),
      3: () => actions.look('right'),
      4: () => actions.look('top'),
      o: () => actions.orthographic(),
      n: () => actions.names(),
      l: () => actions.loop(),
      Escape: () => actions.select(-1),
    }[e.key];
    if (!act || (e.target.getAttribute?.('role') === 'tab' && e.key.startsWith('Arrow'))) return;
    if (act() !== false) e.preventDefault();
  });
}
