// SPDX-License-Identifier: BSD-3-Clause
// What lies over the picture as text and lines: names, axes with gravity, the scales of lengths and of arrows.
import { Vector3 } from 'three';
import { ROUND, roundDown } from './arrows.js';
import { make } from './dom.js';
import { AXES } from './frame.js';

const SVG = 'http://www.w3.org/2000/svg';

function draw(parent, kind, attributes, text) {
  const element = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
}

const short = (value) => Number(value.toPrecision(3)).toString();

// Lengths in common units.
function lengthText(metres) {
  if (metres >= 1) return `${short(metres)} m`;
  if (metres >= 1e-3) return `${short(metres * 1e3)} mm`;
  return `${short(metres * 1e6)} \u00b5m`;
}

export class Overlay {
  constructor(data, world, elements) {
    Object.assign(this, { data, world, elements });
    this.names = { bodies: data.mechanism.moving.length <= 14, links: false };
    this.labels = [];
    for (const index of data.mechanism.moving)
      this.addLabel('body', data.mechanism.bodies[index].name, this.bodyPoint(index), index);
    data.mechanism.links.forEach((link) => {
      if (link.pairs.length === 1)
        this.addLabel('link', link.name, (p) => p.setFromMatrixPosition(world.markers[link.pairs[0][1]].matrixWorld));
    });
  }

  bodyPoint(index) {
    const body = this.data.mechanism.bodies[index],
      group = this.world.bodies.groups[index];
    return (p) => p.set(...body.center).applyMatrix4(group.matrixWorld);
  }

  addLabel(kind, name, place, body = -1) {
    const text = name.length > 40 ? `${name.slice(0, 39)}\u2026` : name;
    const element = make('span', text, { className: `label ${kind}` });
    this.elements.labels.append(element);
    this.labels.push({ kind, element, place, body, width: 0 });
  }

  draw(camera, width, height, metresPerPixel) {
    this.drawLabels(camera, width, height);
    this.drawAxes(camera);
    this.drawScales(metresPerPixel);
  }

  // A name that would lie on another is left out.
  drawLabels(camera, width, height) {
    const taken = [],
      p = new Vector3();
    for (const label of this.labels) {
      const on = label.kind === 'body' ? this.names.bodies : this.names.links;
      label.place(p).project(camera);
      const x = (0.5 + 0.5 * p.x) * width + 9,
        y = (0.5 - 0.5 * p.y) * height - 9;
      label.width ||= Math.min(220, 12 + 6.6 * label.element.textContent.length);
      const clash = taken.some(([a, b, w]) => Math.abs(b - y) < 16 && x < a + w && a < x + label.width);
      const shown = on && !clash && p.z < 1 && x > -20 && x < width && y > 0 && y < height;
      label.element.hidden = !shown;
      if (!shown) continue;
      taken.push([x, y, label.width]);
      label.element.style.transform = `translate(${x.toFixed(1)}px, ${(y - 9).toFixed(1)}px)`;
    }
  }

  drawAxes(camera) {
    const svg = this.elements.axes,
      size = 30;
    svg.replaceChildren();
    const back = camera.quaternion.clone().invert();
    const arms = AXES.map((axis, k) => ['xyz'[k], axis.clone().applyQuaternion(back)]);
    arms.sort(([, a], [, b]) => a.z - b.z);
    const g = new Vector3(...this.data.mechanism.gravity);
    if (g.length() > 0) arms.push(['g', g.normalize().applyQuaternion(back)]);
    for (const [name, arm] of arms) {
      if (Math.hypot(arm.x, arm.y) < 0.08) continue;
      const gravity = name === 'g',
        long = gravity ? 0.62 : 1;
      const x = arm.x * size * long,
        y = -arm.y * size * long,
        d = Math.hypot(x, y),
        [a, b] = [x / d, y / d];
      draw(svg, 'line', { x1: 0, y1: 0, x2: x, y2: y, class: `axis ${name}` });
      draw(svg, 'path', {
        d: `M${x + 2 * a} ${y + 2 * b} L${x - 5 * a - 3 * b} ${y - 5 * b + 3 * a} L${x - 5 * a + 3 * b} ${y - 5 * b - 3 * a} Z`,
        class: `tip ${name}`,
      });
      // Gravity is named beside its arrow, since an axis may lie on it.
      const lx = gravity ? x + 10 * Math.abs(b) + 2 * a : x + 10 * a,
        ly = gravity ? y + 10 * Math.abs(a) * (a < 0 ? -1 : 1) : y + 10 * b;
      draw(svg, 'text', { x: lx, y: ly + 4, class: `word ${name}` }, name);
    }
  }

  drawScales(metresPerPixel) {
    const length = roundDown(110 * metresPerPixel);
    this.elements.scaleBar.style.width = `${length / metresPerPixel}px`;
    this.elements.scaleText.textContent = lengthText(length);
    const { arrows } = this.world;
    const { force, moment } = arrows.scales();
    const full = 100 * metresPerPixel;
    this.elements.arrowScale.replaceChildren();
    const forces = arrows.shown.force && arrows.most.force > 0 ? 'force' : 'reaction';
    if (!arrows.shown.force && !arrows.shown.reaction) return;
    for (const [kind, most, unit] of [[forces, force, 'N'], ['moment', moment, 'N m']]) {
      if (!(most > 0)) continue;
      const value = roundDown((most * full) / (arrows.length * arrows.factor));
      const row = make('div', undefined, { className: `arrow ${kind}` }),
        line = make('i');
      const pixels = ((value / most) * arrows.length * arrows.factor) / metresPerPixel;
      line.style.width = `${kind === 'moment' ? 2 * ROUND * pixels : pixels}px`;
      row.append(line, make('span', `${short(value)} ${unit}`));
      this.elements.arrowScale.append(row);
    }
  }
}
