// SPDX-License-Identifier: BSD-3-Clause
// What spans two points that move: springs, rods of distance links, ropes, belts.
import {
  CatmullRomCurve3,
  CylinderGeometry,
  Group,
  Line,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  Quaternion,
  TubeGeometry,
  Vector3,
} from 'three';

import { lineGeometry, material, sphere } from './shapes.js';
import { theme } from './theme.js';

const Z = new Vector3(0, 0, 1);
const TURNS = 9;

// A coil of length 1 along z, with straight ends on the axis.
function coil(radius, wire) {
  const points = [new Vector3(0, 0, 0), new Vector3(0, 0, 0.1)];
  const n = TURNS * 14;
  for (let i = 0; i <= n; ++i) {
    const a = (i / n) * TURNS * 2 * Math.PI;
    points.push(new Vector3(radius * Math.cos(a), radius * Math.sin(a), 0.13 + (0.74 * i) / n));
  }
  points.push(new Vector3(0, 0, 0.9), new Vector3(0, 0, 1));
  return new TubeGeometry(new CatmullRomCurve3(points, false, 'catmullrom', 0.5), 14 * TURNS * 2, wire, 6);
}

// The marker objects of what is stretched, and its mesh of length 1 along z.
export class Stretched {
  constructor(data, world, unit) {
    this.mats = {
      spring: material(theme.is.spring, { metalness: 0.3 }),
      rod: material(theme.is.joint),
      rope: new LineBasicMaterial({ color: theme.is.ink }),
    };
    this.items = [];
    this.belts = [];
    const { links, forces } = data.mechanism;
    for (const force of forces)
      if (['spring_damper', 'bushing'].includes(force.type) && force.markers.length === 2)
        this.add(world, force.markers, new Mesh(coil(0.9 * unit, 0.13 * unit), this.mats.spring));
    links.forEach((link, number) => {
      if (link.belt) this.addBelt(world, link);
      if (link.type !== 'distance') return;
      const rod = new Mesh(
        new CylinderGeometry(0.3 * unit, 0.3 * unit, 1, 16).rotateX(Math.PI / 2).translate(0, 0, 0.5),
        this.mats.rod,
      );
      const rope = new Line(lineGeometry([0, 0, 0, 0, 0, 1]), this.mats.rope);
      this.add(world, link.pairs[0], link.one_sided ? rope : rod, number);
      for (const m of link.pairs[0]) world.markers[m].add(sphere(0.6 * unit, this.mats.rod, 20));
    });
  }

  addBelt(world, link) {
    const lines = new LineSegments(lineGeometry(new Array(12).fill(0)), this.mats.rope);
    lines.raycast = () => {};
    lines.frustumCulled = false;
    world.root.add(lines);
    this.belts.push({ markers: link.pairs.map(([p]) => world.markers[p]), lines, ...link.belt });
  }

  add(world, markers, mesh, link = -1) {
    const holder = new Group().add(mesh);
    mesh.raycast = () => {};
    world.root.add(holder);
    this.items.push({ from: world.markers[markers[1]], to: world.markers[markers[0]], holder, link });
  }

  seek() {
    this.seekBelts();
    const a = new Vector3(),
      b = new Vector3(),
      turn = new Quaternion();
    for (const { from, to, holder } of this.items) {
      from.updateWorldMatrix(true, false);
      to.updateWorldMatrix(true, false);
      a.setFromMatrixPosition(from.matrixWorld);
      b.setFromMatrixPosition(to.matrixWorld).sub(a);
      const length = Math.max(b.length(), 1e-9);
      holder.position.copy(a);
      holder.quaternion.copy(turn.setFromUnitVectors(Z, b.divideScalar(length)));
      holder.scale.set(1, 1, length);
    }
  }

  // The two straight parts of a belt: tangents of both pulleys, in the plane of the first.
  seekBelts() {
    for (const { markers, lines, radii, crossed } of this.belts) {
      const [a, b] = markers.map((m) => new Vector3().setFromMatrixPosition(m.matrixWorld));
      const axis = new Vector3().setFromMatrixColumn(markers[0].matrixWorld, 2);
      const along = new Vector3().subVectors(b, a),
        distance = along.length();
      along.divideScalar(distance || 1);
      const across = new Vector3().crossVectors(axis, along);
      const cosine = (radii[0] + (crossed ? radii[1] : -radii[1])) / distance,
        sine = Math.sqrt(Math.max(0, 1 - cosine * cosine));
      const ends = [];
      for (const side of [1, -1]) {
        const normal = along
          .clone()
          .multiplyScalar(cosine)
          .addScaledVector(across, side * sine);
        ends.push(
          a.clone().addScaledVector(normal, radii[0]),
          b.clone().addScaledVector(normal, crossed ? -radii[1] : radii[1]),
        );
      }
      const position = lines.geometry.getAttribute('position');
      ends.forEach((p, i) => position.setXYZ(i, p.x, p.y, p.z));
      position.needsUpdate = true;
    }
  }

  show(link, shown) {
    for (const item of this.items) if (item.link === link) item.holder.visible = shown;
  }

  recolor() {
    this.mats.spring.color.set(theme.is.spring);
    this.mats.rod.color.set(theme.is.joint);
    this.mats.rope.color.set(theme.is.ink);
  }
}
