// SPDX-License-Identifier: BSD-3-Clause
// The panel beside the picture: the picked body, the list of bodies, the run, the scene.
import { number } from './plots.js';

function element(kind, text, className) {
  const e = document.createElement(kind);
  if (text !== undefined) e.textContent = text;
  if (className) e.className = className;
  return e;
}

function table(rows) {
  const t = element('table');
  for (const [name, value] of rows) {
    const row = t.insertRow();
    const head = element('th', name);
    head.scope = 'row';
    row.append(head, element('td', value));
  }
  return t;
}

const vector = (v, unit) => `${Array.from(v, number).join(', ')} ${unit}`;

export class Panel {
  constructor(data, world, page, elements) {
    Object.assign(this, { data, world, page, elements });
    this.selected = -1;
    this.addBodies();
    this.addRun();
    elements.scene.textContent = data.text.scene;
  }

  addBodies() {
    const { bodies } = this.data.mechanism;
    this.buttons = new Map();
    bodies.forEach((body, index) => {
      if (body.fixed && body.solids.length === 0) return;
      const b = element('button', body.name.slice(0, 80));
      b.type = 'button';
      b.setAttribute('aria-pressed', 'false');
      b.style.setProperty('--tint', body.fixed ? 'gray' : this.world.colorOf(index));
      b.addEventListener('click', () => this.page.select(this.selected === index ? -1 : index));
      this.elements.bodies.append(b);
      this.buttons.set(index, b);
    });
    this.showBody(-1);
  }

  recolor() {
    for (const [index, b] of this.buttons)
      if (!this.data.mechanism.bodies[index].fixed) b.style.setProperty('--tint', this.world.colorOf(index));
  }

  showBody(index) {
    this.selected = index;
    for (const [i, b] of this.buttons) b.setAttribute('aria-pressed', String(i === index));
    const holder = this.elements.body;
    holder.replaceChildren();
    this.live = null;
    if (index < 0) {
      holder.append(element('p', 'Pick a body in the picture or in this list.', 'note'));
      return;
    }
    const body = this.data.mechanism.bodies[index];
    holder.append(element('h3', body.name));
    this.live = element('div');
    holder.append(this.live, this.fixedFacts(body), ...this.links(index), ...this.channels(body.name));
    this.showTime();
  }

  fixedFacts(body) {
    if (body.fixed) return table([['fixed', 'it never moves']]);
    const [a, b, c, d, e, f] = body.inertia;
    const rows = [
      ['mass', `${number(body.mass)} kg`],
      ['mass centre', vector(body.center, 'm')],
    ];
    if (!body.particle) rows.push(['inertia xx, yy, zz', vector([a, b, c], 'kg m\u00b2')]);
    if (!body.particle && (d || e || f)) rows.push(['inertia xy, yz, zx', vector([d, e, f], 'kg m\u00b2')]);
    return table(rows);
  }

  links(index) {
    const { links, forces, markers, bodies } = this.data.mechanism;
    const on = (m) => markers[m].body === index;
    const names = (list) =>
      [...new Set(list.filter((m) => !on(m)).map((m) => bodies[markers[m].body].name))].join(', ');
    const why = new Map(this.data.text.marked ?? []);
    const rows = [
      ...links
        .filter((l) => l.pairs.flat().some(on))
        .map((l) => [
          l.name,
          `${l.type} with ${names(l.pairs.flat()) || 'itself'}${l.drives?.length ? ', driven' : ''}${why.has(l.name) ? `; ${why.get(l.name)}` : ''}`,
        ]),
      ...forces
        .filter((f) => f.markers.some(on))
        .map((f) => [f.name, `${f.type}${names(f.markers) ? ` with ${names(f.markers)}` : ''}`]),
    ];
    return rows.length ? [element('h4', 'Links and forces'), table(rows)] : [];
  }

  channels(name) {
    const channel = new Map(this.data.text.channels);
    const rows = this.data.table.columns
      .filter((c) => (channel.get(c.name) ?? c.name).startsWith(`${name}.`))
      .map((c) => [c.name, channel.get(c.name) ?? '']);
    return rows.length ? [element('h4', 'Recorded'), table(rows)] : [];
  }

  showTime() {
    if (!this.live) return;
    const i = this.data.mechanism.moving.indexOf(this.selected);
    const home = this.data.mechanism.bodies[this.selected].home;
    const { bodies, velocities } = this.world.motion;
    const q = i < 0 ? [home[4], home[5], home[6], home[3]] : bodies.subarray(7 * i + 3, 7 * i + 7);
    const rows = [
      ['position', vector(i < 0 ? home.slice(0, 3) : bodies.subarray(7 * i, 7 * i + 3), 'm')],
      ['orientation w, x, y, z', vector([q[3], q[0], q[1], q[2]], '')],
    ];
    if (i >= 0)
      rows.push(
        ['velocity', vector(velocities.subarray(6 * i, 6 * i + 3), 'm/s')],
        ['angular velocity', vector(velocities.subarray(6 * i + 3, 6 * i + 6), 'rad/s')],
      );
    rows.push(...this.idleLinks());
    this.live.replaceChildren(table(rows));
  }

  // Links of the picked body that were switched off, or do not hold yet.
  idleLinks() {
    const { links, markers } = this.data.mechanism,
      { t } = this.world.motion;
    const states = this.world.switches.statesAt(t);
    const rows = [];
    links.forEach((link, k) => {
      if (states[k] === 'holds' || !link.pairs.flat().some((m) => markers[m].body === this.selected)) return;
      rows.push([link.name, this.offWords(k, t) || 'not in force yet']);
    });
    return rows;
  }

  // "switched off at 0.33 s, by event 'cut'"; "": it was not until t.
  offWords(link, t) {
    const off = this.world.switches.offAt(link, t);
    return off ? `switched off at ${number(off.t)} s${off.what ? `, by ${off.what}` : ''}` : '';
  }

  // What stands out of the links during the whole run.
  remarks() {
    const { links } = this.data.mechanism;
    const rows = [...(this.data.text.marked ?? [])];
    links.forEach((link, k) => {
      if (link.merged || link.one_sided) return;
      const off = this.data.switches.later.filter((s) => s.link === k && !s.active);
      for (const s of off.slice(0, 5)) rows.push([link.name, this.offWords(k, s.t)]);
    });
    if (rows.length === 0) return [];
    const t = table(rows.slice(0, 200));
    t.className = 'remarks';
    return [element('h3', 'Links that are marked'), t];
  }

  addRun() {
    const { text, mechanism, frames, table: columns } = this.data,
      holder = this.elements.run;
    for (const warning of text.warnings) holder.append(element('p', warning, 'warning'));
    if (text.description) holder.append(element('p', text.description));
    const count = (n, one, many) => `${n} ${n === 1 ? one : many}`;
    holder.append(
      element('h3', 'Run'),
      this.facts(text.facts),
      ...this.remarks(),
      element('h3', 'Mechanism'),
      table([
        ['bodies', `${mechanism.moving.length} that move`],
        ['links', String(mechanism.links.length)],
        ['forces', String(mechanism.forces.length)],
        ['gravity', vector(mechanism.gravity, 'm/s\u00b2')],
        [
          'recorded',
          `${count(columns.columns.length - 1, 'column', 'columns')} in ${count(columns.rows, 'row', 'rows')}${columns.stride > 1 ? `; every ${columns.stride}th is in this file` : ''}`,
        ],
        ['instants drawn', `${frames.n}${frames.stride > 1 ? `; every ${frames.stride}th is in this file` : ''}`],
      ]),
      element('h3', 'Made by'),
      table([
        ['lockstep', text.version],
        ['on', text.machine],
      ]),
    );
    if (text.command) holder.append(element('pre', text.command));
  }

  // "NOT CONSERVED" and its like stand out.
  facts(facts) {
    const t = element('table');
    for (const [name, value] of facts) {
      const row = t.insertRow();
      const head = element('th', name);
      head.scope = 'row';
      row.append(head, element('td', value));
      if (/^[A-Z ]+$/.test(name) && name !== '') row.className = 'bad';
      if (name === 'conserved') row.className = 'good';
    }
    return t;
  }
}
