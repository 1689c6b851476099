// SPDX-License-Identifier: BSD-3-Clause
// Tabs, with arrow keys as usual.

export function addTabs(list) {
  const tabs = [...list.querySelectorAll('[role=tab]')];
  const show = (id) => {
    for (const tab of tabs) {
      const on = tab.id === id;
      tab.setAttribute('aria-selected', String(on));
      tab.tabIndex = on ? 0 : -1;
      document.getElementById(tab.getAttribute('aria-controls')).hidden = !on;
    }
  };
  tabs.forEach((tab, i) => {
    tab.addEventListener('click', () => show(tab.id));
    tab.addEventListener('keydown', (e) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
      if (!step) return;
      const next = tabs[(i + step + tabs.length) % tabs.length];
      show(next.id);
      next.focus();
      e.preventDefault();
    });
  });
  return show;
}
