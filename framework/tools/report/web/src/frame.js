// SPDX-License-Identifier: BSD-3-Clause
// Frame: how the mechanism lies in space: its size, its centre, up, and the plane in which it moves.
import { Box3, Quaternion, Vector3 } from 'three';

// Instants, evenly spread, at which the motion is looked at.
export function instants(motion, most) {
  const { times } = motion,
    length = Math.min(most, times.length);
  return Array.from({ length }, (_, i) => times[Math.round((i * (times.length - 1)) / Math.max(1, length - 1))]);
}

export const AXES = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];

// The normal of the plane to which all bodies keep: none leaves it or turns out of it.
function planeOf(data, motion, size) {
  if (data.mechanism.plane >= 0) return data.mechanism.plane;
  const left = new Set([2, 1, 0]),
    first = [];
  for (const t of instants(motion, 24)) {
    motion.seek(t);
    for (let i = 0; i < motion.nBodies; ++i) {
      const x = motion.bodies.slice(7 * i, 7 * i + 3),
        back = new Quaternion().fromArray(motion.bodies, 7 * i + 3).conjugate(),
        axes = AXES.map((axis) => axis.clone().applyQuaternion(back)); // as the body sees them
      first[i] ??= { x, axes };
      const turned = (n) => axes[n].distanceTo(first[i].axes[n]) > 1e-4;
      for (const n of left) if (Math.abs(x[n] - first[i].x[n]) > 1e-5 * size || turned(n)) left.delete(n);
    }
    if (left.size === 0) return -1;
  }
  return [...left][0];
}

function upOf(gravity, plane) {
  const g = new Vector3(...gravity);
  if (g.length() > 0) {
    const along = AXES.map((a) => Math.abs(a.dot(g)));
    if (plane >= 0) along[plane] = 0;
    const k = along.indexOf(Math.max(...along));
    if (along[k] > 0) return AXES[k].clone().multiplyScalar(-Math.sign(AXES[k].dot(g)));
  }
  return plane === 2 ? AXES[1].clone() : AXES[2].clone();
}

// Where everything is during the run: of each body its corners, of each marker its origin.
function extent(world, motion) {
  const box = new Box3(),
    point = new Vector3(),
    sizes = [],
    points = [];
  for (const t of instants(motion, 40)) {
    world.seek(t);
    const now = new Box3();
    for (const p of world.bodies.keyPoints()) {
      now.expandByPoint(point.copy(p));
      if (points.length < 20000) points.push(p.clone());
    }
    if (now.isEmpty()) continue;
    sizes.push(now.getSize(point).length());
    box.union(now);
  }
  if (box.isEmpty()) box.expandByPoint(new Vector3());
  sizes.sort((a, b) => a - b);
  if (points.length === 0) points.push(new Vector3());
  return { box, points, size: sizes[sizes.length >> 1] || 0 };
}

// Whether centres of mass lie, or move, beside one another in the plane: what only turns about one axis is better seen in
// space.
function spreads(world, plane, length) {
  const box = new Box3();
  for (const t of instants(world.motion, 24)) {
    world.seek(t);
    for (const x of world.bodies.centers()) box.expandByPoint(x);
  }
  const size = box.max.sub(box.min);
  return [1, 2].some((k) => size.getComponent((plane + k) % 3) > 0.02 * length);
}

export function frameOf(data, motion, world) {
  const { box, points, size } = extent(world, motion);
  const whole = box.getSize(new Vector3()).length();
  const length = Math.max(size, 0.15 * whole, 0.5 * data.mechanism.length, 1e-6);
  let plane = planeOf(data, motion, length);
  if (plane >= 0 && !spreads(world, plane, length)) plane = -1;
  const up = upOf(data.mechanism.gravity, plane);
  const front = AXES[plane >= 0 ? plane : Math.abs(up.z) > 0.5 ? 1 : 2].clone();
  if (front.y > 0) front.negate();
  if (Math.abs(up.x) > 0.5 && plane < 0) front.set(0, 0, 1);
  const right = new Vector3().crossVectors(up, front).normalize();
  const center = box.getCenter(new Vector3());
  return { box, points, size: length, reach: Math.max(whole, length), center, plane, up, front, right };
}
