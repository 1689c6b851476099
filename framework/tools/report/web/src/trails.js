// SPDX-License-Identifier: BSD-3-Clause
// Trails: the ways of points of bodies during the run; the part that lies behind is drawn stronger.
import { Line, LineBasicMaterial } from 'three';
import { indexAt } from './motion.js';
import { geometryOf, material, movePoints, sphere, unpicked } from './shapes.js';

// Instants for a smooth way: every frame, and some between them where there are few.
function trailTimes(motion, most = 3000) {
  const { times } = motion;
  const between = Math.min(8, Math.max(1, Math.floor(most / Math.max(1, times.length))));
  const every = Math.max(1, Math.ceil(times.length / most));
  const list = [];
  for (let k = 0; k + 1 < times.length; k += every)
    for (let i = 0; i < between; ++i)
      list.push(times[k] + ((times[Math.min(k + every, times.length - 1)] - times[k]) * i) / between);
  return [...list, motion.end];
}

export class Trails {
  constructor(motion, world) {
    Object.assign(this, { motion, world });
    this.lines = new Map(); // by the key of a point
    this.shown = true;
  }

  // `object`: what is followed; `point`: in its axes.
  add(key, object, point, color) {
    if (this.lines.has(key)) return;
    const times = trailTimes(this.motion);
    const geometry = geometryOf(this.way(object, point, times));
    const whole = new Line(geometry, new LineBasicMaterial({ transparent: true, opacity: 0.28, depthWrite: false }));
    const past = new Line(geometry.clone(), new LineBasicMaterial({}));
    const dot = sphere(0.4 * this.world.unit, material('#000000'), 16);
    dot.position.copy(point);
    for (const part of [whole, past, dot]) unpicked(part);
    whole.frustumCulled = past.frustumCulled = false;
    this.world.root.add(whole, past);
    object.add(dot);
    this.lines.set(key, { times, whole, past, dot, color, object, point });
    this.recolor();
  }

  // Where the point is at each of the times.
  way(object, point, times) {
    const numbers = [];
    const now = this.motion.t;
    for (const t of times) {
      this.world.pose(t);
      numbers.push(...object.localToWorld(point.clone()));
    }
    if (Number.isFinite(now)) this.world.pose(now);
    return numbers;
  }

  // After the motion has become another one.
  redo() {
    for (const { times, whole, past, object, point } of this.lines.values()) {
      const numbers = this.way(object, point, times);
      for (const line of [whole, past]) movePoints(line, numbers);
    }
  }

  remove(key) {
    const trail = this.lines.get(key);
    if (!trail) return;
    this.world.root.remove(trail.whole, trail.past);
    trail.dot.removeFromParent();
    this.lines.delete(key);
  }

  seek(t) {
    for (const { times, whole, past, dot } of this.lines.values()) {
      whole.visible = past.visible = dot.visible = this.shown;
      past.geometry.setDrawRange(0, indexAt(times, t) + 1);
    }
  }

  recolor() {
    for (const { whole, past, dot, color } of this.lines.values())
      for (const line of [whole, past, dot]) line.material.color.set(color());
  }
}
