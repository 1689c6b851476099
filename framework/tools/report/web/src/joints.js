// SPDX-License-Identifier: BSD-3-Clause
// Joints: a symbol for each kind of mask, at the markers of the link, with its axis.
import {
  Group,
  LineBasicMaterial,
  LineDashedMaterial,
  LineLoop,
  LineSegments,
  Line,
  Mesh,
  OctahedronGeometry,
  PlaneGeometry,
  TorusGeometry,
  Vector3,
} from 'three';
import { freedoms } from './freedoms.js';
import { box, cylinder, lineGeometry, material, sphere, tube } from './shapes.js';
import { theme } from './theme.js';

export function kindOf(link) {
  if (link.mask === undefined || link.pairs.length !== 1) return 'coupling';
  if (link.type === 'distance') return 'distance';
  if (link.type === 'stop') return 'stop';
  if (link.curves) return 'curve';
  if (link.type === 'universal') return 'universal';
  if (link.type === 'screw') return 'screw';
  const { slides, turns } = freedoms(link.mask);
  const key = `${slides.length}${turns.length}`;
  const kinds = {
    '00': 'fixed',
    '01': 'hinge',
    10: 'slide',
    11: 'cylindrical',
    '03': 'ball',
    '02': 'bent',
    13: 'line',
    23: 'plane',
    21: 'sheet',
    20: 'sheet',
  };
  return kinds[key] ?? 'other';
}

// Turns an object whose axis is z so that it is the axis k.
function along(object, k) {
  if (k === 0) object.rotation.set(0, Math.PI / 2, 0);
  if (k === 1) object.rotation.set(-Math.PI / 2, 0, 0);
  return object;
}

function axisLine(length, mats) {
  const line = new Line(lineGeometry([0, 0, -length, 0, 0, length]), mats.axis);
  line.computeLineDistances();
  line.raycast = () => {};
  return line;
}

// Symbols: `p` belongs to the marker P, `s` to the marker S, both with z as their axis.
const SYMBOLS = {
  hinge(u, mats) {
    const s = new Group(),
      p = new Group();
    s.add(cylinder(0.85 * u, 1.9 * u, mats.solid), axisLine(3 * u, mats));
    p.add(cylinder(0.42 * u, 2.02 * u, mats.pin));
    return { p, s };
  },
  slide(u, mats, travel) {
    const s = new Group(),
      p = new Group();
    const rail = box([0.5 * u, 0.5 * u, travel[1] - travel[0] + 5 * u], mats.rail, mats.edge);
    rail.position.z = 0.5 * (travel[0] + travel[1]);
    s.add(rail);
    p.add(box([1.5 * u, 1.5 * u, 2.4 * u], mats.solid, mats.edge));
    return { p, s };
  },
  cylindrical(u, mats, travel) {
    const s = new Group(),
      p = new Group();
    const rail = cylinder(0.3 * u, travel[1] - travel[0] + 5 * u, mats.rail);
    rail.position.z = 0.5 * (travel[0] + travel[1]);
    s.add(rail);
    p.add(cylinder(0.8 * u, 2.4 * u, mats.solid, mats.edge));
    return { p, s };
  },
  screw(u, mats, travel) {
    const { p, s } = SYMBOLS.cylindrical(u, mats, travel);
    const low = travel[0] - 2.5 * u,
      high = travel[1] + 2.5 * u,
      points = [];
    for (let i = 0; i <= 400; ++i) {
      const a = (i / 400) * ((high - low) / (0.8 * u)) * 2 * Math.PI;
      points.push(0.42 * u * Math.cos(a), 0.42 * u * Math.sin(a), low + ((high - low) * i) / 400);
    }
    s.add(new Line(lineGeometry(points), mats.line));
    return { p, s };
  },
  ball(u, mats) {
    const s = new Group(),
      p = new Group();
    p.add(sphere(0.8 * u, mats.solid));
    const cup = new Mesh(new TorusGeometry(0.95 * u, 0.16 * u, 12, 36), mats.rail);
    s.add(cup);
    return { p, s };
  },
  bent(u, mats) {
    const { p, s } = SYMBOLS.ball(u, mats);
    s.add(axisLine(3 * u, mats));
    return { p, s };
  },
  universal(u, mats) {
    const s = new Group(),
      p = new Group();
    s.add(along(cylinder(0.28 * u, 2.6 * u, mats.rail), 0));
    p.add(along(cylinder(0.28 * u, 2.6 * u, mats.pin2), 1), sphere(0.55 * u, mats.solid));
    return { p, s };
  },
  line(u, mats, travel) {
    const s = new Group(),
      p = new Group();
    const rail = cylinder(0.2 * u, travel[1] - travel[0] + 5 * u, mats.rail);
    rail.position.z = 0.5 * (travel[0] + travel[1]);
    s.add(rail);
    p.add(sphere(0.7 * u, mats.solid));
    return { p, s };
  },
  plane(u, mats) {
    const { p, s } = SYMBOLS.sheet(u, mats);
    p.clear();
    p.add(sphere(0.6 * u, mats.solid));
    return { p, s };
  },
  sheet(u, mats) {
    const s = new Group(),
      p = new Group();
    s.add(new Mesh(new PlaneGeometry(7 * u, 7 * u), mats.sheet));
    const r = 3.5 * u;
    s.add(new LineLoop(lineGeometry([-r, -r, 0, r, -r, 0, r, r, 0, -r, r, 0]), mats.line));
    p.add(cylinder(0.9 * u, 0.4 * u, mats.solid));
    return { p, s };
  },
  fixed(u, mats) {
    const s = new Group(),
      p = new Group();
    p.add(box([1.1 * u, 1.1 * u, 1.1 * u], mats.solid, mats.edge));
    return { p, s };
  },
  curve(u, mats) {
    const s = new Group(),
      p = new Group();
    p.add(sphere(0.4 * u, mats.solid));
    return { p, s };
  },
  other(u, mats) {
    const s = new Group(),
      p = new Group();
    p.add(new Mesh(new OctahedronGeometry(0.8 * u), mats.solid));
    return { p, s };
  },
  none: () => ({ p: new Group(), s: new Group() }),
};
for (const kind of ['coupling', 'distance', 'stop']) SYMBOLS[kind] = SYMBOLS.none;

// Curves of a link, in the axes of a marker; of a wheel a spoke as well, which shows that it turns.
function addCurves(link, markers, unit, mats) {
  const added = [];
  for (const curve of link.curves ?? []) {
    const marker = markers[link.pairs[curve.pair][curve.side === 'p' ? 0 : 1]];
    if (curve.points.length < 6) continue;
    const group = new Group();
    group.add(tube(curve.points, curve.closed, (curve.closed ? 0.14 : 0.2) * unit, mats.rail));
    if (curve.closed) {
      const [x, y, z] = curve.points;
      group.add(
        new LineLoop(lineGeometry(curve.points), mats.wheel),
        new Line(lineGeometry([0, 0, 0, x, y, z]), mats.wheel),
      );
    }
    marker.add(group);
    added.push(group);
  }
  return added;
}

// How far P moves along the free axis of S during the run.
function travelOf(link, k, world, times) {
  const [p, s] = link.pairs[0].map((m) => world.markers[m]);
  const range = [Infinity, -Infinity];
  const x = new Vector3();
  for (const t of times) {
    world.seek(t);
    s.updateWorldMatrix(true, false);
    p.updateWorldMatrix(true, false);
    s.worldToLocal(x.setFromMatrixPosition(p.matrixWorld));
    range[0] = Math.min(range[0], x.getComponent(k));
    range[1] = Math.max(range[1], x.getComponent(k));
  }
  return range[0] <= range[1] ? range : [0, 0];
}

// The base of a hinge on the ground of a planar mechanism: a triangle on a hatched line.
function groundMark(u, frame, mats) {
  const points = [0, 0, -1.9, -2.4, -1.9, -2.4, 1.9, -2.4, 1.9, -2.4, 0, 0, -2.7, -2.4, 2.7, -2.4];
  for (let i = -2; i <= 3; ++i) points.push(0.9 * i - 0.1, -2.4, 0.9 * i - 0.8, -3.2);
  const numbers = [];
  for (let i = 0; i < points.length; i += 2) {
    const p = new Vector3().addScaledVector(frame.right, points[i] * u).addScaledVector(frame.up, points[i + 1] * u);
    numbers.push(p.x, p.y, p.z);
  }
  const mark = new LineSegments(lineGeometry(numbers), mats.line);
  mark.raycast = () => {};
  return mark;
}

export class Joints {
  constructor(data, world, frame, unit, times) {
    this.data = data;
    this.mats = { ink: this.materials(theme.is.joint), drive: this.materials(theme.is.drive) };
    this.symbols = data.mechanism.links.map((link) => this.symbol(link, world, frame, unit, times));
  }

  materials(color) {
    return {
      solid: material(color),
      rail: material(theme.is.ground),
      pin: material(theme.is.pin),
      pin2: material(theme.is.ground),
      sheet: material(theme.is.ground, { transparent: true, opacity: 0.18, side: 2, depthWrite: false }),
      line: new LineBasicMaterial({ color: theme.is.soft }),
      edge: theme.is.dark ? '#000000' : '#1c2530',
      wheel: new LineBasicMaterial({ color: theme.is.ink, depthTest: false, transparent: true, opacity: 0.6 }),
      axis: new LineDashedMaterial({ color: theme.is.soft, dashSize: 1, gapSize: 0.5 }),
    };
  }

  symbol(link, world, frame, unit, times) {
    const kind = kindOf(link);
    const mats = link.drives?.length ? this.mats.drive : this.mats.ink;
    mats.axis.dashSize = 0.8 * unit;
    mats.axis.gapSize = 0.4 * unit;
    const free = link.mask === undefined ? { slides: [], turns: [] } : freedoms(link.mask);
    const axis =
      free.turns.length === 1
        ? free.turns[0]
        : free.slides.length === 1
          ? free.slides[0]
          : free.slides.length === 2
            ? [0, 1, 2].find((k) => !free.slides.includes(k))
            : 2;
    const slides = ['slide', 'cylindrical', 'line', 'screw'].includes(kind);
    const travel = slides ? travelOf(link, kind === 'screw' ? 2 : free.slides[0], world, times) : [0, 0];
    const parts = SYMBOLS[kind](unit, mats, travel);
    const added = addCurves(link, world.markers, unit, mats);
    if (link.rack) added.push(this.rack(link, world, unit, mats, times));
    if (link.pairs.length > 0) {
      const [p, s] = link.pairs[0];
      const turned = [parts.p, parts.s].map((part) => new Group().add(along(part, axis)));
      world.markers[p].add(turned[0]);
      world.markers[s].add(turned[1]);
      added.push(...turned);
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
    const group = new Group().add(bar);
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

  recolor() {
    const tint = (mats, color) => {
      mats.solid.color.set(color);
      mats.rail.color.set(theme.is.ground);
      mats.pin2.color.set(theme.is.ground);
      mats.sheet.color.set(theme.is.ground);
      mats.pin.color.set(theme.is.pin);
      mats.line.color.set(theme.is.soft);
      mats.axis.color.set(theme.is.soft);
      mats.wheel.color.set(theme.is.ink);
    };
    tint(this.mats.ink, theme.is.joint);
    tint(this.mats.drive, theme.is.drive);
  }
}
