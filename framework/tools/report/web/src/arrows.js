// SPDX-License-Identifier: BSD-3-Clause
// Arrows: what joints and forces exert, with one scale for forces and one for moments.
import { ConeGeometry, CylinderGeometry, Group, Mesh, TorusGeometry, Vector3 } from 'three';
import { inked, unpicked } from './shapes.js';

const Y = new Vector3(0, 1, 0);
export const ROUND = 0.35; // radius of a moment's arrow, where a force's would be 1 long

// A round number up to the value: 1, 2 or 5 times a power of ten.
export function roundDown(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const n = value / power;
  return (n >= 5 ? 5 : n >= 2 ? 2 : 1) * power;
}

// Along y, from the origin: a shaft of length 1 to be stretched, and a head.
function straight(mat, unit) {
  const group = new Group();
  group.shaft = new Mesh(new CylinderGeometry(0.16 * unit, 0.16 * unit, 1, 14).translate(0, 0.5, 0), mat);
  group.head = new Mesh(new ConeGeometry(0.45 * unit, 1.3 * unit, 18).translate(0, -0.65 * unit, 0), mat);
  group.add(group.shaft, group.head);
  return group;
}

// Two thirds of a circle of radius 1 about y, in the sense of the moment, with a head.
function round(mat) {
  const group = new Group(),
    end = 1.4 * Math.PI;
  const arc = new Mesh(new TorusGeometry(1, 0.055, 10, 48, end), mat);
  const head = new Mesh(new ConeGeometry(0.17, 0.5, 18), mat);
  head.position.set(Math.cos(end + 0.2), Math.sin(end + 0.2), 0);
  head.rotation.z = end + 0.2;
  const about = new Group().add(arc, head); // the circle lies about z
  about.rotation.x = -Math.PI / 2;
  group.add(about);
  return group;
}

// The largest magnitudes of all loads during the run.
function largest(motion, loads) {
  const most = { force: 0, reaction: 0, forceMoment: 0, reactionMoment: 0 };
  const first = 13 * motion.nBodies + 7 * motion.nMarkers;
  const take = (kind, at) => {
    const size = Math.hypot(motion.rows[at], motion.rows[at + 1], motion.rows[at + 2]);
    if (size > most[kind] && Number.isFinite(size)) most[kind] = size;
  };
  for (let k = 0; k < motion.times.length; ++k)
    loads.forEach(({ reaction }, i) => {
      const at = k * motion.width + first + 6 * i;
      take(reaction ? 'reaction' : 'force', at);
      take(reaction ? 'reactionMoment' : 'forceMoment', at + 3);
    });
  return most;
}

export class Arrows {
  constructor(data, motion, world, frame, unit) {
    Object.assign(this, { world, unit });
    this.length = 0.24 * frame.size;
    this.loads = data.mechanism.loads;
    this.factor = 1;
    this.shown = { force: true, reaction: false };
    this.most = largest(motion, this.loads);
    // What is only rounding is no moment.
    const rounding = 1e-9 * frame.size * Math.max(this.most.force, this.most.reaction);
    for (const kind of ['forceMoment', 'reactionMoment']) if (this.most[kind] < rounding) this.most[kind] = 0;
    // Bars do not hide what they bear.
    const seen = (name) => inked(name, { depthTest: false, transparent: true });
    const [ofForces, ofReactions, ofMoments] = ['force', 'reaction', 'moment'].map(seen);
    this.items = this.loads.map((load) => {
      const force = straight(load.reaction ? ofReactions : ofForces, unit);
      const moment = round(ofMoments);
      for (const object of [force, moment])
        object.traverse((part) => Object.assign(unpicked(part), { renderOrder: 5 }));
      world.root.add(force, moment);
      return { load, force, moment };
    });
  }

  // What a full arrow stands for: one scale for all that is shown, so that arrows compare.
  scales() {
    const { force, reaction } = this.shown,
      m = this.most;
    return {
      force: Math.max(force ? m.force : 0, reaction ? m.reaction : 0),
      moment: Math.max(force ? m.forceMoment : 0, reaction ? m.reactionMoment : 0),
    };
  }

  seek(motion) {
    const scale = this.scales();
    this.items.forEach(({ load, force, moment }, i) => {
      const on = load.reaction ? this.shown.reaction : this.shown.force;
      const marker = this.world.markers[load.marker];
      marker.updateWorldMatrix(true, false);
      const length = this.turn(force, marker, motion.loads, 6 * i, scale.force, on);
      if (force.visible) this.stretch(force, length);
      const radius = this.turn(moment, marker, motion.loads, 6 * i + 3, scale.moment, on) * ROUND;
      if (moment.visible) moment.scale.setScalar(radius);
    });
  }

  // Puts an arrow at its marker along its vector; returns its length.
  turn(object, marker, loads, at, scale, on) {
    const v = new Vector3().fromArray(loads, at);
    const size = v.length(),
      length = scale === 0 ? 0 : (size / scale) * this.length * this.factor;
    object.visible = on && Number.isFinite(length) && length > 0.15 * this.unit;
    if (!object.visible) return 0;
    object.position.setFromMatrixPosition(marker.matrixWorld);
    object.quaternion.setFromUnitVectors(Y, v.divideScalar(size));
    return length;
  }

  stretch({ shaft, head }, length) {
    const width = Math.min(1, length / (2.6 * this.unit));
    head.position.y = length;
    head.scale.setScalar(width);
    shaft.scale.set(width, Math.max(1e-9, length - 0.6 * this.unit * width), width);
  }
}
