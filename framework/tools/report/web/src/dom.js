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

// A table of two columns: names and values.
export function factsTable(rows) {
  const table = make('table');
  for (const [name, value] of rows)
    table.insertRow().append(make('th', name, { scope: 'row' }), make('td', value));
  return table;
}

// A table with the titles of its columns; its rows are for the caller to add.
export function titledTable(titles, properties) {
  const table = make('table', undefined, properties);
  table.createTHead().insertRow().append(...titles.map((title) => make('th', title, { scope: 'col' })));
  return table;
}
