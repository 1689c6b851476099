// SPDX-License-Identifier: BSD-3-Clause
// The panel next to the picture: the selected body, the list of bodies, the run, the scene.
import { button, factsTable, make, press } from './dom.js';
import { number } from './plots.js';
import { offAt, statesAt } from './switches.js';

// Whether the checks of a run failed, by their words.
export const isBad = (checks) => /\bnot conserved|VIOLATED/.test(checks);

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
      const b = button(body.name.slice(0, 80), () => this.page.select(this.selected === index ? -1 : index));
      press(b, false);
      b.style.setProperty('--tint', body.fixed ? 'gray' : this.world.colorOf(index));
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
    for (const [i, b] of this.buttons) press(b, i === index);
    const holder = this.elements.body;
    holder.replaceChildren();
    this.live = null;
    if (index < 0) {
      holder.append(make('p', 'Select a body in the picture or in this list.', { className: 'note' }));
      return;
    }
    const body = this.data.mechanism.bodies[index];
    holder.append(make('h3', body.name));
    this.live = make('div');
    holder.append(this.live, this.fixedFacts(body), ...this.links(index), ...this.channels(body.name));
    this.showTime();
  }

  fixedFacts(body) {
    if (body.fixed) return factsTable([['fixed', 'does not move']]);
    const [a, b, c, d, e, f] = body.inertia;
    const rows = [
      ['mass', `${number(body.mass)} kg`],
      ['centre of mass', vector(body.center, 'm')],
    ];
    if (!body.particle) rows.push(['inertia xx, yy, zz', vector([a, b, c], 'kg m\u00b2')]);
    if (!body.particle && (d || e || f)) rows.push(['inertia xy, yz, zx', vector([d, e, f], 'kg m\u00b2')]);
    return factsTable(rows);
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
    return rows.length ? [make('h4', 'Joints and forces'), factsTable(rows)] : [];
  }

  channels(name) {
    const channel = new Map(this.data.text.channels);
    const rows = this.data.table.columns
      .filter((c) => (channel.get(c.name) ?? c.name).startsWith(`${name}.`))
      .map((c) => [c.name, channel.get(c.name) ?? '']);
    return rows.length ? [make('h4', 'Recorded'), factsTable(rows)] : [];
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
    this.live.replaceChildren(factsTable(rows));
  }

  // Joints of the selected body that were deactivated, or are not active yet.
  idleLinks() {
    const { links, markers } = this.data.mechanism,
      { t } = this.world.motion;
    const states = statesAt(this.data, t);
    const rows = [];
    links.forEach((link, k) => {
      if (states[k] === 'holds' || !link.pairs.flat().some((m) => markers[m].body === this.selected)) return;
      rows.push([link.name, this.offWords(k, t) || 'not active yet']);
    });
    return rows;
  }

  // "deactivated at 0.33 s, by event 'cut'"; "": it was not until t.
  offWords(link, t) {
    const off = offAt(this.data, link, t);
    return off ? `deactivated at ${number(off.t)} s${off.what ? `, by ${off.what}` : ''}` : '';
  }

  // Remarks on joints, for the whole run.
  remarks() {
    const { links } = this.data.mechanism;
    const rows = [...(this.data.text.marked ?? [])];
    links.forEach((link, k) => {
      if (link.merged || link.one_sided) return;
      const off = this.data.switches.later.filter((s) => s.link === k && !s.active);
      for (const s of off.slice(0, 5)) rows.push([link.name, this.offWords(k, s.t)]);
    });
    if (rows.length === 0) return [];
    return [make('h3', 'Remarks on joints'), Object.assign(factsTable(rows.slice(0, 200)), { className: 'remarks' })];
  }

  addRun() {
    const { text, mechanism, frames, table: columns } = this.data,
      holder = this.elements.run;
    for (const warning of text.warnings) holder.append(make('p', warning, { className: 'warning' }));
    if (text.description) holder.append(make('p', text.description));
    const count = (n, one) => `${n} ${one}${n === 1 ? '' : 's'}`;
    const kept = columns.stride > 1 ? `; 1 in ${columns.stride} is in this file, and the extremes between` : '';
    const recorded = `${count(columns.columns.filter((c) => !c.before).length - 1, 'column')} in ${count(columns.rows, 'row')}${kept}`;
    holder.append(
      make('h3', 'Run'),
      this.facts(text.facts),
      ...this.remarks(),
      make('h3', 'Mechanism'),
      factsTable([
        ['moving bodies', String(mechanism.moving.length)],
        ['joints', String(mechanism.links.length)],
        ['forces', String(mechanism.forces.length)],
        ['gravity', vector(mechanism.gravity, 'm/s\u00b2')],
        ['recorded', recorded],
        ['frames', `${frames.n}${frames.stride > 1 ? `: 1 output time in ${frames.stride}` : ''}`],
      ]),
      make('h3', 'Created by'),
      factsTable([['lockstep', text.version], ['on', text.machine]]),
    );
    if (text.command) holder.append(make('pre', text.command));
  }

  // The verdict on the energy is coloured. A line without a name is one of a table: its columns stay.
  facts(facts) {
    const table = factsTable(facts);
    facts.forEach(([name, value], i) => {
      const row = table.rows[i];
      if (isBad(value)) row.className = 'bad';
      else if (/\b(energy ok|conserved)\b/.test(value)) row.className = 'good';
      if (name) return;
      row.cells[0].remove();
      Object.assign(row.cells[0], { colSpan: 2, className: 'line' });
    });
    return table;
  }
}
