// SPDX-License-Identifier: BSD-3-Clause
// Elements of the page.

export const byId = (id) => document.getElementById(id);

// An element with a text, where it has one, and with properties.
export function make(kind, text, properties = {}) {
  const element = document.createElement(kind);
  if (text !== undefined) element.textContent = text;
  return Object.assign(element, properties);
}

export function button(text, act, properties = {}) {
  const element = make('button', text, { type: 'button', ...properties });
  element.addEventListener('click', act);
  return element;
}

export const press = (element, on) => element.setAttribute('aria-pressed', String(on));

// Makes a button switch a property of an object on and off.
export function toggles(element, object, key, changed = () => {}) {
  press(element, object[key]);
  element.addEventListener('click', () => {
    object[key] = !object[key];
    press(element, object[key]);
    changed();
  });
}

// A press of the mouse that is no drag.
export function whenClicked(element, act) {
  let down = null;
  element.addEventListener('pointerdown', (e) => (down = e));
  element.addEventListener('click', (e) => {
    if (down && Math.hypot(e.clientX - down.clientX, e.clientY - down.clientY) < 4) act(e);
  });
}

// A table of names and values.
export function factsTable(rows) {
  const table = make('table');
  for (const [name, ...values] of rows)
    table.insertRow().append(make('th', name, { scope: 'row', title: name }), ...values.map((v) => make('td', v)));
  return table;
}

// A table with the titles of its columns; its rows are for the caller to add.
export function titledTable(titles, properties) {
  const table = make('table', undefined, properties);
  table.createTHead().insertRow().append(...titles.map((title) => make('th', title, { scope: 'col' })));
  return table;
}
