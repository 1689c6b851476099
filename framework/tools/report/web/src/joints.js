// SPDX-License-Identifier: BSD-3-Clause
// Joints: a symbol for each kind of mask, at the markers of the joint, with its axis.
import * as THREE from 'three';
import { markerOf } from './bodies.js';
import { freedoms } from './freedoms.js';
import { extentOf } from './marks.js';
import { along, box, cylinder, geometryOf, inked, sphere, tube, unpicked } from './shapes.js';
import { theme } from './theme.js';

// Kinds by the numbers of axes along which they slide and about which they turn.
const KINDS = [
  ['fixed', 'hinge', 'bent', 'ball'],
  ['slide', 'cylindrical', 'other', 'line'],
  ['sheet', 'sheet', 'other', 'plane'],
];

function kindOf(link) {
  if (link.mask === undefined || link.pairs.length !== 1) return 'coupling';
  if (['distance', 'stop'].includes(link.type)) return link.type;
  if (link.curves) return 'curve';
  if (['universal', 'screw'].includes(link.type)) return link.type;
  const { slides, turns } = freedoms(link.mask);
  return KINDS[slides.length]?.[turns.length] ?? 'other';
}

function axisLine(length, mats) {
  const line = new THREE.Line(geometryOf([0, 0, -length, 0, 0, length]), mats.axis);
  return unpicked(line.computeLineDistances());
}

// Along z, past all places of what slides on it; `make` is given its length.
function rail(u, [low, high], make) {
  const object = make(high - low + 5 * u);
  object.position.z = 0.5 * (low + high);
  return object;
}

function thread(u, mats, travel) {
  const low = travel[0] - 2.5 * u,
    high = travel[1] + 2.5 * u,
    points = [];
  for (let i = 0; i <= 400; ++i) {
    const a = (i / 400) * ((high - low) / (0.8 * u)) * 2 * Math.PI;
    points.push(0.42 * u * Math.cos(a), 0.42 * u * Math.sin(a), low + ((high - low) * i) / 400);
  }
  return new THREE.Line(geometryOf(points), mats.line);
}

function ball(u, mats) {
  const cup = new THREE.Mesh(new THREE.TorusGeometry(0.95 * u, 0.16 * u, 12, 36), mats.rail);
  return { p: [sphere(0.8 * u, mats.solid)], s: [cup] };
}

function cylindrical(u, mats, travel) {
  return {
    s: [rail(u, travel, (length) => cylinder(0.3 * u, length, mats.rail))],
    p: [cylinder(0.8 * u, 2.4 * u, mats.solid, mats.edge)],
  };
}

function sheet(u, mats) {
  const r = 3.5 * u;
  const edge = new THREE.LineLoop(geometryOf([-r, -r, 0, r, -r, 0, r, r, 0, -r, r, 0]), mats.line);
  return {
    s: [new THREE.Mesh(new THREE.PlaneGeometry(2 * r, 2 * r), mats.sheet), edge],
    p: [cylinder(0.9 * u, 0.4 * u, mats.solid)],
  };
}

// Symbols: `p` belongs to the marker P, `s` to the marker S, both with z as their axis.
const SYMBOLS = {
  hinge: (u, mats) => ({
    s: [cylinder(0.85 * u, 1.9 * u, mats.solid), axisLine(3 * u, mats)],
    p: [cylinder(0.42 * u, 2.02 * u, mats.pin)],
  }),
  slide: (u, mats, travel) => ({
    s: [rail(u, travel, (length) => box([0.5 * u, 0.5 * u, length], mats.rail, mats.edge))],
    p: [box([1.5 * u, 1.5 * u, 2.4 * u], mats.solid, mats.edge)],
  }),
  cylindrical,
  screw(u, mats, travel) {
    const { p, s } = cylindrical(u, mats, travel);
    return { p, s: [...s, thread(u, mats, travel)] };
  },
  ball,
  bent(u, mats) {
    const { p, s } = ball(u, mats);
    return { p, s: [...s, axisLine(3 * u, mats)] };
  },
  universal: (u, mats) => ({
    s: [along(cylinder(0.28 * u, 2.6 * u, mats.rail), 0)],
    p: [along(cylinder(0.28 * u, 2.6 * u, mats.rail), 1), sphere(0.55 * u, mats.solid)],
  }),
  line: (u, mats, travel) => ({
    s: [rail(u, travel, (length) => cylinder(0.2 * u, length, mats.rail))],
    p: [sphere(0.7 * u, mats.solid)],
  }),
  plane: (u, mats) => ({ ...sheet(u, mats), p: [sphere(0.6 * u, mats.solid)] }),
  sheet,
  fixed: (u, mats) => ({ p: [box([1.1 * u, 1.1 * u, 1.1 * u], mats.solid, mats.edge)] }),
  curve: (u, mats) => ({ p: [sphere(0.4 * u, mats.solid)] }),
  other: (u, mats) => ({ p: [new THREE.Mesh(new THREE.OctahedronGeometry(0.8 * u), mats.solid)] }),
};

// Curves of a joint, in the axes of a marker; of a wheel a spoke as well, which shows its rotation.
function addCurves(link, markers, unit, mats) {
  const added = [];
  for (const curve of link.curves ?? []) {
    if (curve.points.length < 6) continue;
    const group = new THREE.Group();
    group.add(tube(curve.points, curve.closed, (curve.closed ? 0.14 : 0.2) * unit, mats.rail));
    if (curve.closed) {
      const [x, y, z] = curve.points;
      group.add(
        new THREE.LineLoop(geometryOf(curve.points), mats.wheel),
        new THREE.Line(geometryOf([0, 0, 0, x, y, z]), mats.wheel),
      );
    }
    markers[markerOf(link, curve)].add(group);
    added.push(group);
  }
  return added;
}

// How far P moves along the free axis of S during the run.
function travelOf(link, k, world, times) {
  const [p, s] = link.pairs[0].map((m) => world.markers[m]);
  const places = times.map((t) => {
    world.seek(t);
    return s.worldToLocal(p.getWorldPosition(new THREE.Vector3())).getComponent(k);
  });
  const [low, high] = extentOf(places, places.keys());
  return low <= high ? [low, high] : [0, 0];
}

// The base of a hinge on the ground of a planar mechanism: a triangle on a hatched line.
function groundMark(u, frame, mats) {
  const points = [0, 0, -1.9, -2.4, -1.9, -2.4, 1.9, -2.4, 1.9, -2.4, 0, 0, -2.7, -2.4, 2.7, -2.4];
  for (let i = -2; i <= 3; ++i) points.push(0.9 * i - 0.1, -2.4, 0.9 * i - 0.8, -3.2);
  const numbers = [];
  for (let i = 0; i < points.length; i += 2) {
    const p = new THREE.Vector3();
    p.addScaledVector(frame.right, points[i] * u).addScaledVector(frame.up, points[i + 1] * u);
    numbers.push(...p);
  }
  return unpicked(new THREE.LineSegments(geometryOf(numbers), mats.line));
}

function materials(name, unit) {
  const wheel = new THREE.LineBasicMaterial({ depthTest: false, transparent: true, opacity: 0.6 });
  return {
    solid: inked(name),
    rail: inked('ground'),
    pin: inked('pin'),
    sheet: inked('ground', { transparent: true, opacity: 0.18, side: 2, depthWrite: false }),
    line: theme.tinted('soft', new THREE.LineBasicMaterial()),
    edge: theme.is.dark ? '#000000' : '#1c2530',
    wheel: theme.tinted('ink', wheel),
    axis: theme.tinted('soft', new THREE.LineDashedMaterial({ dashSize: 0.8 * unit, gapSize: 0.4 * unit })),
  };
}

// The axis of a symbol: about which alone it turns, along which alone it slides, or across which it slides.
function axisOf({ slides, turns }) {
  if (turns.length === 1) return turns[0];
  if (slides.length === 1) return slides[0];
  return slides.length === 2 ? [0, 1, 2].find((k) => !slides.includes(k)) : 2;
}

export class Joints {
  constructor(data, world, frame, unit, times) {
    this.data = data;
    this.mats = { ink: materials('joint', unit), drive: materials('drive', unit) };
    this.symbols = data.mechanism.links.map((link) => this.symbol(link, world, frame, unit, times));
  }

  symbol(link, world, frame, unit, times) {
    const kind = kindOf(link);
    const mats = link.drives?.length ? this.mats.drive : this.mats.ink;
    const free = link.mask === undefined ? { slides: [], turns: [] } : freedoms(link.mask);
    const slides = ['slide', 'cylindrical', 'line', 'screw'].includes(kind);
    const travel = slides ? travelOf(link, kind === 'screw' ? 2 : free.slides[0], world, times) : [0, 0];
    const { p = [], s = [] } = SYMBOLS[kind]?.(unit, mats, travel) ?? {};
    const added = addCurves(link, world.markers, unit, mats);
    if (link.rack) added.push(this.rack(link, world, unit, mats, times));
    if (link.pairs.length > 0) {
      for (const [k, parts] of [p, s].entries()) {
        const group = new THREE.Group();
        for (const part of parts) group.add(part);
        const turned = new THREE.Group().add(along(group, axisOf(free)));
        world.markers[link.pairs[0][k]].add(turned);
        added.push(turned);
      }
      this.addGroundMark(link, kind, world, frame, unit, mats, added);
    }
    return added;
  }

  // The rack on which a pinion rolls along x of S.
  rack(link, world, unit, mats, times) {
    const [from, to] = travelOf(link, 0, world, times),
      length = to - from + 2 * Math.abs(link.rack);
    const bar = box([length, 0.8 * unit, 1.6 * unit], mats.rail, mats.edge);
    bar.position.set(0.5 * (from + to), -link.rack - Math.sign(link.rack) * 0.4 * unit, 0);
    const group = new THREE.Group().add(bar);
    world.markers[link.pairs[0][1]].add(group);
    return group;
  }

  addGroundMark(link, kind, world, frame, unit, mats, added) {
    if (kind !== 'hinge' || frame.plane < 0) return;
    const { bodies, markers } = this.data.mechanism;
    const held = link.pairs[0].find((m) => bodies[markers[m].body].fixed);
    if (held === undefined) return;
    const mark = groundMark(unit, frame, mats);
    world.markers[held].updateWorldMatrix(true, false);
    mark.position.setFromMatrixPosition(world.markers[held].matrixWorld);
    world.root.add(mark);
    added.push(mark);
  }

  // Links that are not in force are not shown.
  show(link, shown) {
    for (const part of this.symbols[link]) part.visible = shown;
  }
}
