// SPDX-License-Identifier: BSD-3-Clause
// Bodies: their solids; where a scene gives only an inertia, bars between their joints, or the ellipsoid of the inertia.
import { BufferGeometry, EllipseCurve, Group, LineBasicMaterial, LineLoop, Object3D, Quaternion, Vector3 } from 'three';
import { freedoms } from './freedoms.js';
import { cornersOf, Meshes } from './meshes.js';
import { along, bar, box, centerMark, cylinder, material, plate, sphere, unpicked } from './shapes.js';
import { theme } from './theme.js';

const point = (p) => new Vector3().fromArray(p);

// Of x y z and a quaternion, scalar first.
export function setPose(object, at) {
  object.position.fromArray(at);
  object.quaternion.set(at[4], at[5], at[6], at[3]);
  return object;
}

// The k-th pose of x y z and a quaternion, scalar last.
export function setPoseOf(object, poses, k) {
  object.position.fromArray(poses, 7 * k);
  object.quaternion.fromArray(poses, 7 * k + 3);
}

// The number of the marker on which a curve of a joint is drawn.
export const markerOf = (link, curve) => link.pairs[curve.pair][curve.side === 'p' ? 0 : 1];

// The points of a body at which others hold it, or which the scene names, each once; in its own frame.
export function attachments(index, data, size) {
  const points = [];
  for (const marker of data.mechanism.markers) {
    if (marker.body !== index) continue;
    const p = point(marker.at);
    if (points.every((q) => q.distanceTo(p) > 1e-4 * size)) points.push(p);
  }
  return points;
}

function shapeOf(solid, mats, unit, meshes) {
  if (solid.kind === 'mesh') return meshes.object(solid.mesh, solid.size, mats.mesh, mats.edge);
  const [x, y, z] = solid.size.map((v) => Math.max(v, 1e-9));
  if (solid.kind === 'box') return box([x, y, z], mats.solid, mats.edge);
  if (solid.kind === 'sphere') return sphere(x / 2, mats.solid);
  return cylinder(Math.max(x / 2, z > 8 * x ? 0.45 * unit : 0), z, mats.solid, mats.edge);
}

// Semi-axes of the solid ellipsoid with this mass and diagonal inertia, bounded to what a picture bears.
function semiAxes(body, size) {
  const [a, b, c] = body.inertia,
    f = 2.5 / body.mass;
  const least = Number.isFinite(size) ? 0.012 * size : 0;
  const bound = (square) => Math.min(0.22 * size, Math.max(least, Math.sqrt(Math.max(0, f * square))));
  return [bound(b + c - a), bound(c + a - b), bound(a + b - c)];
}

// With its three great circles, which show its rotation.
function ellipsoid(body, mats, size) {
  const mesh = sphere(1, mats.solid, 40);
  for (const k of [0, 1, 2]) mesh.add(greatCircle(k, mats.edge));
  mesh.scale.set(...semiAxes(body, size));
  mesh.position.copy(point(body.center));
  return mesh;
}

function greatCircle(axis, color) {
  const circle = new BufferGeometry().setFromPoints(new EllipseCurve(0, 0, 1.003, 1.003).getPoints(64));
  const mat = new LineBasicMaterial({ color, transparent: true, opacity: 0.4 });
  return along(unpicked(new LineLoop(circle, mat)), axis);
}

// Corners of the convex hull of points in a plane, in order; `normal` is set.
function hull(points, normal) {
  const [arm, ...others] = points.slice(1).map((p) => new Vector3().subVectors(p, points[0]));
  const normals = others.map((other) => new Vector3().crossVectors(arm, other));
  const far = normals.find((n) => n.length() > 1e-3 * arm.lengthSq());
  if (!far) return null;
  normal.copy(far.normalize());
  const span = Math.max(...points.map((p) => p.distanceTo(points[0])));
  if (others.some((other) => Math.abs(other.dot(far)) > 1e-3 * span)) return null;
  const e1 = arm.normalize(),
    e2 = new Vector3().crossVectors(far, e1);
  const flat = points.map((p) => ({ p, x: p.dot(e1), y: p.dot(e2) })).sort((a, b) => a.x - b.x || a.y - b.y);
  const side = (list) => {
    const out = [];
    for (const q of list) {
      while (out.length > 1) {
        const [a, b] = out.slice(-2);
        if ((b.x - a.x) * (q.y - a.y) - (b.y - a.y) * (q.x - a.x) > 0) break;
        out.pop();
      }
      out.push(q);
    }
    return out.slice(0, -1);
  };
  return [...side(flat), ...side(flat.reverse())].map((q) => q.p);
}
// The two points furthest apart.
function ends(points) {
  let best = [points[0], points[1]],
    most = -1;
  for (const a of points) for (const b of points) if (a.distanceTo(b) > most) [best, most] = [[a, b], a.distanceTo(b)];
  return best;
}

function addSkeleton(group, center, points, mats, unit) {
  const radius = 0.5 * unit;
  const normal = new Vector3();
  const corners = points.length > 2 ? hull(points, normal) : null;
  if (corners && corners.length > 2) {
    corners.forEach((p, i) => group.add(bar(p, corners[(i + 1) % corners.length], radius, mats.solid)));
    group.add(plate(corners, normal, mats.sheet));
    for (const p of points) if (!corners.includes(p)) group.add(bar(p, nearest(p, corners), radius, mats.solid));
  } else if (points.length > 2 && !collinear(points)) {
    const middle = points.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(points.length);
    for (const p of points) group.add(bar(middle, p, radius, mats.solid));
  } else {
    const beyond = beyondEnds(points, center, unit);
    group.add(bar(...ends(beyond ? [...points, center] : points), radius, mats.solid));
    if (beyond) group.add(bar(center, center, 1.7 * unit, mats.solid));
  }
  if (!corners) addSideways(group, points, center, mats, unit);
}

// Whether the centre of mass lies on the line of the points, but further out: a weight on an arm.
function beyondEnds(points, center, unit) {
  const [a, b] = ends(points),
    all = [...points, center];
  return collinear(all) && Math.max(center.distanceTo(a), center.distanceTo(b)) > a.distanceTo(b) + 2 * unit;
}

// A centre of mass beside the bar of its body: a sheet from the bar to it.
function addSideways(group, points, center, mats, unit) {
  const [a, b] = ends(points);
  const normal = new Vector3().crossVectors(new Vector3().subVectors(b, a), new Vector3().subVectors(center, a));
  if (normal.length() < 2.5 * unit * a.distanceTo(b) || !collinear(points)) return;
  group.add(plate([a, b, center], normal.normalize(), mats.sheet));
}

function nearest(p, others) {
  return others.reduce((best, q) => (q.distanceTo(p) < best.distanceTo(p) ? q : best));
}

function collinear(points) {
  const [a, b] = ends(points),
    along = new Vector3().subVectors(b, a).normalize();
  return points.every((p) => new Vector3().subVectors(p, a).cross(along).length() < 1e-3 * a.distanceTo(b));
}

function addNeutral(group, body, points, mats, { unit, size, isWheel, shaft }) {
  const center = point(body.center);
  const arm = points.length === 1 && !body.particle ? points[0].distanceTo(center) : 0;
  if (body.particle) group.add(sphere(1.1 * unit, mats.solid));
  else if (points.length > 1) addSkeleton(group, center, points, mats, unit);
  else if (points.length === 0) group.add(ellipsoid(body, mats, 3 * size));
  else if (arm > 0.05 * size) group.add(ellipsoid(body, mats, Math.min(size, 1.6 * arm)));
  else if (shaft) group.add(shaftAlong(shaft, center, mats, unit));
  else if (!isWheel) {
    const block = box([3.4 * unit, 2.8 * unit, 2.8 * unit], mats.solid, mats.edge);
    block.position.copy(center);
    group.add(block);
  }
  if (arm > 0.01 * size) group.add(bar(points[0], center, 0.4 * unit, mats.solid));
}

// Bodies on which the curve of a gear, a belt or a cam is drawn, by number.
function wheelsOf({ mechanism }) {
  const wheels = new Set();
  for (const link of mechanism.links)
    for (const curve of link.curves ?? [])
      if (curve.closed) wheels.add(mechanism.markers[markerOf(link, curve)].body);
  return wheels;
}

// The axis, in its own frame, about which a joint lets a body turn as a shaft; null: none.
function axisOf(index, { mechanism }) {
  for (const link of mechanism.links) {
    if (link.mask === undefined || link.pairs.length !== 1) continue;
    const { slides, turns } = freedoms(link.mask);
    const marker = link.pairs[0].map((m) => mechanism.markers[m]).find((m) => m.body === index);
    if (slides.length > 0 || turns.length !== 1 || !marker) continue;
    const [, , , w, x, y, z] = marker.at;
    return new Vector3().setComponent(turns[0], 1).applyQuaternion(new Quaternion(x, y, z, w));
  }
  return null;
}

// A shaft with a key, which shows its rotation.
function shaftAlong(axis, center, mats, unit) {
  const shaft = new Group();
  const key = box([0.35 * unit, 0.35 * unit, 9 * unit], mats.solid, mats.edge);
  key.position.set(0.6 * unit, 0, 0);
  shaft.add(cylinder(0.6 * unit, 10 * unit, mats.solid, mats.edge), key);
  shaft.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), axis);
  shaft.position.copy(center);
  return shaft;
}

const CUBE = { low: [-0.5, -0.5, -0.5], size: [1, 1, 1] };

function matrixOf(at) {
  const holder = setPose(new Object3D(), at);
  holder.updateMatrix();
  return holder.matrix;
}

// Those of its materials that have the colour of the body.
const colored = ({ mats }) => [mats.solid, mats.mesh, mats.sheet];

// A group for every body of the mechanism, by number, with what it looks like. Fixed bodies stay at home.
export class Bodies {
  constructor(data, root) {
    this.data = data;
    this.meshes = new Meshes(data.meshes ?? []);
    this.groups = data.mechanism.bodies.map((body, index) => {
      const group = setPose(new Group(), body.home);
      Object.assign(group, { name: body.name, userData: { body: index } });
      root.add(group);
      return group;
    });
    this.reaches = data.mechanism.bodies.map((_, i) => this.ellipsoidReach(i));
    this.moving = data.mechanism.moving.map((index) => this.groups[index]);
  }

  seek(motion) {
    this.moving.forEach((group, i) => setPoseOf(group, motion.bodies, i));
  }

  // centres of mass of bodies that move, in the world.
  centers() {
    return this.data.mechanism.moving.map((i) => this.inWorld(i, point(this.data.mechanism.bodies[i].center)));
  }

  inWorld(body, p) {
    return p.applyMatrix4(this.groups[body].matrixWorld);
  }

  // How far the ellipsoid reaches as which a body may be drawn, at most: where nothing says what it looks like.
  ellipsoidReach(i) {
    const body = this.data.mechanism.bodies[i];
    if (body.fixed || body.particle || body.solids.length > 0) return 0;
    const points = attachments(i, this.data, 0);
    if (points.length === 0) return this.data.mechanism.length;
    return points.length === 1 ? 0.35 * points[0].distanceTo(point(body.center)) : 0;
  }

  // Points that a picture should hold, in the world: of every body its corners and its centre of mass.
  *keyPoints() {
    const { data } = this,
      { bodies, markers, links, forces } = data.mechanism;
    for (const [i, body] of bodies.entries()) {
      this.groups[i].updateMatrixWorld();
      if (!body.fixed) yield this.inWorld(i, point(body.center));
      if (this.reaches[i] > 0)
        for (const [k, a] of semiAxes(body, Infinity).entries())
          for (const arm of [-1, 1].map((side) => side * Math.min(a, this.reaches[i])))
            yield this.inWorld(i, point(body.center).setComponent(k, body.center[k] + arm));
      for (const solid of body.solids) {
        const place = matrixOf(solid.at);
        for (const corner of cornersOf(solid.kind === 'mesh' ? data.meshes[solid.mesh] : CUBE, solid.size))
          yield this.inWorld(i, point(corner).applyMatrix4(place));
      }
    }
    for (const link of links)
      for (const curve of link.curves ?? []) {
        if (!curve.closed) continue;
        const marker = markers[markerOf(link, curve)],
          place = matrixOf(marker.at);
        for (let i = 0; i < curve.points.length; i += 36)
          yield this.inWorld(marker.body, new Vector3().fromArray(curve.points, i).applyMatrix4(place));
      }
    const used = new Set([...links.flatMap((link) => link.pairs.flat()), ...forces.flatMap((force) => force.markers)]);
    for (let m = 0; m < markers.length; ++m)
      if (!bodies[markers[m].body].fixed || used.has(m))
        yield this.inWorld(markers[m].body, point(markers[m].at));
  }

  // `unit`: the size of symbols.
  dress(frame, unit) {
    let number = 0;
    const wheels = wheelsOf(this.data);
    this.looks = this.data.mechanism.bodies.map((body, index) => {
      const group = this.groups[index];
      const color = body.fixed ? null : number++;
      const look = { color, own: body.look?.color ?? '', opacity: body.look?.opacity ?? 1, mats: null, center: null };
      look.mats = this.materials(look);
      for (const solid of body.solids) group.add(setPose(shapeOf(solid, look.mats, unit, this.meshes), solid.at));
      if (body.solids.length === 0 && !body.fixed)
        addNeutral(group, body, attachments(index, this.data, frame.size), look.mats, {
          unit,
          size: frame.size,
          isWheel: wheels.has(index),
          shaft: axisOf(index, this.data),
        });
      if (!body.fixed) {
        look.center = centerMark(0.75 * unit);
        look.center.position.copy(point(body.center));
        look.center.visible = false;
        group.add(look.center);
      }
      return look;
    });
  }

  tintOf({ color, own }) {
    return own || (color === null ? theme.is.ground : theme.bodyColor(color));
  }

  materials(look) {
    const tint = this.tintOf(look),
      glass = look.opacity < 1 ? { transparent: true, opacity: look.opacity, depthWrite: false } : {};
    return {
      solid: material(tint, glass),
      mesh: material(tint, { ...glass, flatShading: true, side: 2 }),
      sheet: material(tint, { transparent: true, opacity: 0.28 * look.opacity, side: 2, depthWrite: false }),
      edge: theme.is.dark ? '#000000' : '#1c2530',
    };
  }

  recolor() {
    for (const look of this.looks) for (const mat of colored(look)) mat.color.set(this.tintOf(look));
  }

  // Marks one body; -1: none.
  select(index) {
    this.looks.forEach((look, i) => {
      for (const mat of colored(look)) {
        mat.emissive.set(i === index ? look.mats.solid.color : '#000000');
        mat.emissiveIntensity = i === index ? 0.35 : 0;
      }
    });
  }

  showCenters(shown, selected) {
    this.looks.forEach((look, i) => {
      if (look.center) look.center.visible = shown || i === selected;
    });
  }
}
