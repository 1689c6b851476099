// SPDX-License-Identifier: BSD-3-Clause
// World: everything that is drawn in space, at one time.
import { Group, Vector3 } from 'three';
import { Arrows } from './arrows.js';
import { Badges } from './badges.js';
import { addBodiesBefore } from './before.js';
import { Bodies, attachments, setPose, setPoseOf } from './bodies.js';
import { frameOf, instants } from './frame.js';
import { Joints } from './joints.js';
import { Stretched } from './stretched.js';
import { statesAt } from './switches.js';
import { Trails } from './trails.js';

// The size of symbols: a part of the mechanism, less where its parts are small.
function unitOf(data, frame) {
  const lengths = [];
  data.mechanism.bodies.forEach((body, index) => {
    const points = attachments(index, data, frame.size);
    for (let i = 1; i < points.length; ++i) lengths.push(points[i].distanceTo(points[i - 1]));
  });
  lengths.sort((a, b) => a - b);
  const typical = lengths.length > 2 ? lengths[lengths.length >> 1] : frame.size;
  return Math.max(0.005 * frame.size, Math.min(0.024 * frame.size, 0.13 * typical));
}

export class World {
  constructor(data, motion) {
    Object.assign(this, { data, motion });
    this.root = new Group();
    this.bodies = new Bodies(data, this.root);
    this.markers = data.mechanism.markers.map((marker) => {
      const object = setPose(new Group(), marker.at);
      this.bodies.groups[marker.body].add(object);
      return object;
    });
    this.movedMarkers = data.mechanism.moved_markers.map((m) => {
      this.root.attach(this.markers[m]);
      return this.markers[m];
    });
    this.frame = frameOf(data, motion, this);
    this.unit = unitOf(data, this.frame);
    this.bodies.dress(this.frame, this.unit);
    if (data.before) this.seekBefore = addBodiesBefore(data.before, this);
    this.joints = new Joints(data, this, this.frame, this.unit, instants(motion, 60));
    this.stretched = new Stretched(data, this, this.unit);
    this.badges = new Badges(data, this, this.unit);
    this.arrows = new Arrows(data, motion, this, this.frame, this.unit);
    this.trails = new Trails(motion, this);
    this.addTrails();
    this.active = null;
    this.seek(motion.start);
  }

  // Of the markers that the scene itself names on bodies that move; of few bodies also their centres of mass.
  addTrails() {
    const { bodies, markers, links, forces } = this.data.mechanism;
    const used = new Set([...links.flatMap((l) => l.pairs.flat()), ...forces.flatMap((f) => f.markers)]);
    let n = 0;
    markers.forEach((marker, m) => {
      if (used.has(m) || bodies[marker.body].fixed || n > 7) return;
      this.trails.add(`marker ${m}`, this.markers[m], new Vector3(), () => this.colorOf(marker.body));
      ++n;
    });
    if (n === 0 && this.data.mechanism.moving.length <= 4)
      for (const body of this.data.mechanism.moving) this.addBodyTrail(body);
  }

  addBodyTrail(body) {
    const center = new Vector3(...this.data.mechanism.bodies[body].center);
    this.trails.add(`body ${body}`, this.bodies.groups[body], center, () => this.colorOf(body));
  }

  colorOf(body) {
    return this.bodies.tintOf(this.bodies.looks[body]);
  }

  // Poses alone.
  pose(t) {
    this.motion.seek(t);
    this.bodies.seek(this.motion);
    this.movedMarkers.forEach((object, i) => setPoseOf(object, this.motion.markers, i));
    this.root.updateMatrixWorld(true);
  }

  seek(t) {
    this.pose(t);
    if (!this.trails) return;
    this.seekBefore?.(t);
    this.stretched.seek();
    this.arrows.seek(this.motion);
    this.trails.seek(t);
    this.showActive(t);
  }

  // Links that are not in force are not shown; those that were deactivated leave a cross.
  showActive(t) {
    const states = statesAt(this.data, t),
      key = states.join();
    if (key === this.active) return;
    this.active = key;
    states.forEach((state, i) => {
      const { merged, one_sided: oneSided } = this.data.mechanism.links[i];
      this.badges.show(i, state);
      if (merged || oneSided) return;
      this.joints.show(i, state === 'holds');
      this.stretched.show(i, state === 'holds');
    });
  }

  recolor() {
    this.bodies.recolor();
    this.trails.recolor();
  }
}
