// SPDX-License-Identifier: BSD-3-Clause
// Trails: the ways of points of bodies during the run, or about the present time of a long one; the part that lies behind is drawn stronger.
import { Line, LineBasicMaterial } from 'three';
import { indexAt } from './motion.js';
import { geometryOf, material, movePoints, sphere, unpicked } from './shapes.js';

const MOST = 3000; // points of a trail

// The frame at which trails begin: of many, at least half of the points lie behind the present time.
function firstFrame({ times, t }) {
  const chunk = Math.floor((2 * indexAt(times, t)) / MOST);
  return Math.max(0, Math.min(((chunk - 1) * MOST) / 2, times.length - MOST));
}

// Instants for a smooth way: the frames from the first one on, and some between them if they are few.
function trailTimes({ times, end }, first) {
  if (times.length >= MOST) return times.slice(first, first + MOST);
  const between = Math.min(8, Math.max(1, Math.floor(MOST / Math.max(1, times.length))));
  const list = [];
  for (let k = 0; k + 1 < times.length; ++k)
    for (let i = 0; i < between; ++i) list.push(times[k] + ((times[k + 1] - times[k]) * i) / between);
  return [...list, end];
}

export class Trails {
  constructor(motion, world) {
    Object.assign(this, { motion, world });
    this.lines = new Map(); // by the key of a point
    this.first = 0;
    this.times = trailTimes(motion, 0);
    this.shown = true;
  }

  // `object`: what is followed; `point`: in its axes.
  add(key, object, point, color) {
    if (this.lines.has(key)) return;
    const geometry = geometryOf(this.ways([{ object, point }])[0]);
    const whole = new Line(geometry, new LineBasicMaterial({ transparent: true, opacity: 0.28, depthWrite: false }));
    const past = new Line(geometry.clone(), new LineBasicMaterial({}));
    const dot = sphere(0.4 * this.world.unit, material('#000000'), 16);
    dot.position.copy(point);
    for (const part of [whole, past, dot]) unpicked(part);
    whole.frustumCulled = past.frustumCulled = false;
    this.world.root.add(whole, past);
    object.add(dot);
    this.lines.set(key, { whole, past, dot, color, object, point });
    this.recolor();
  }

  // Where points are at each of the times.
  ways(points) {
    const all = points.map(() => []);
    const now = this.motion.t;
    for (const t of this.times) {
      this.world.pose(t);
      points.forEach(({ object, point }, i) => all[i].push(...object.localToWorld(point.clone())));
    }
    if (Number.isFinite(now)) this.world.pose(now);
    return all;
  }

  // After the motion has become another one, or trails begin at another frame.
  redo() {
    const trails = [...this.lines.values()];
    this.ways(trails).forEach((numbers, i) => {
      for (const line of [trails[i].whole, trails[i].past]) movePoints(line, numbers);
    });
  }

  remove(key) {
    const trail = this.lines.get(key);
    if (!trail) return;
    this.world.root.remove(trail.whole, trail.past);
    trail.dot.removeFromParent();
    this.lines.delete(key);
  }

  seek(t) {
    const first = firstFrame(this.motion);
    if (first !== this.first) {
      Object.assign(this, { first, times: trailTimes(this.motion, first) });
      this.redo();
    }
    for (const { whole, past, dot } of this.lines.values()) {
      whole.visible = past.visible = dot.visible = this.shown;
      past.geometry.setDrawRange(0, indexAt(this.times, t) + 1);
    }
  }

  recolor() {
    for (const { whole, past, dot, color } of this.lines.values())
      for (const line of [whole, past, dot]) line.material.color.set(color());
  }
}
