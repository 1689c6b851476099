// Arrows: what links and forces exert, with one scale for forces and one for moments.
import { ConeGeometry, CylinderGeometry, Group, Mesh, Quaternion, Vector3 } from 'three';
import { material } from './shapes.js';
import { theme } from './theme.js';

const Y = new Vector3(0, 1, 0);

// A round number up to the value: 1, 2 or 5 times a power of ten.
export function roundDown(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const n = value / power;
  return (n >= 5 ? 5 : n >= 2 ? 2 : 1) * power;
}

function arrow(mat, unit, heads) {
  const group = new Group();
  const shaft = new Mesh(new CylinderGeometry(0.16 * unit, 0.16 * unit, 1, 14).translate(0, 0.5, 0), mat);
  group.add(shaft);
  group.heads = [];
  for (let i = 0; i < heads; ++i) {
    const head = new Mesh(new ConeGeometry(0.45 * unit, 1.3 * unit, 18).translate(0, -0.65 * unit, 0), mat);
    group.add(head);
    group.heads.push(head);
  }
  group.shaft = shaft;
  group.traverse((part) => { part.raycast = () => {}; });
  return group;
}

// The largest magnitude during the run of the loads that `chosen` takes.
function largest(motion, loads, offset, chosen) {
  let most = 0;
  const first = 13 * motion.nBodies + 7 * motion.nMarkers;
  for (let k = 0; k < motion.times.length; ++k)
    loads.forEach((load, i) => {
      if (!chosen(load)) return;
      const at = k * motion.width + first + 6 * i + offset;
      const size = Math.hypot(motion.rows[at], motion.rows[at + 1], motion.rows[at + 2]);
      if (size > most && Number.isFinite(size)) most = size;
    });
  return most;
}

export class Arrows {
  constructor(data, motion, world, frame, unit) {
    this.unit = unit;
    this.length = 0.24 * frame.size;
    this.loads = data.mechanism.loads;
    this.world = world;
    this.factor = 1;
    this.shown = { force: true, reaction: false, moment: true };
    this.most = {
      force: largest(motion, this.loads, 0, (l) => !l.reaction),
      reaction: largest(motion, this.loads, 0, (l) => l.reaction),
      forceMoment: largest(motion, this.loads, 3, (l) => !l.reaction),
      reactionMoment: largest(motion, this.loads, 3, (l) => l.reaction),
    };
    this.mats = { force: material(theme.is.force), reaction: material(theme.is.reaction), moment: material(theme.is.moment) };
    this.items = this.loads.map((load) => {
      const force = arrow(load.reaction ? this.mats.reaction : this.mats.force, unit, 1);
      const moment = arrow(this.mats.moment, unit, 2);
      world.root.add(force, moment);
      return { load, force, moment };
    });
  }

  get any() { return this.loads.length > 0; }

  // What a full arrow stands for: one scale for all that is shown, so that arrows compare.
  scales() {
    const { force, reaction } = this.shown, m = this.most;
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
      this.place(force, marker, motion.loads, 6 * i, scale.force, on);
      this.place(moment, marker, motion.loads, 6 * i + 3, scale.moment, on && this.shown.moment);
    });
  }

  place(object, marker, loads, at, scale, on) {
    const v = new Vector3(loads[at], loads[at + 1], loads[at + 2]);
    const size = v.length(), length = (size / scale) * this.length * this.factor;
    object.visible = on && Number.isFinite(length) && length > 0.15 * this.unit;
    if (!object.visible) return;
    object.position.setFromMatrixPosition(marker.matrixWorld);
    object.quaternion.copy(new Quaternion().setFromUnitVectors(Y, v.divideScalar(size)));
    const head = Math.min(1, length / (2.6 * this.unit));
    object.heads.forEach((h, k) => {
      h.position.y = length - k * 0.9 * this.unit * head;
      h.scale.setScalar(head);
    });
    object.shaft.scale.set(head, Math.max(1e-9, length - 0.6 * this.unit * head), head);
  }

  recolor() {
    for (const kind of ['force', 'reaction', 'moment']) this.mats[kind].color.set(theme.is[kind]);
  }
}
