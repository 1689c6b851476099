// SPDX-License-Identifier: BSD-3-Clause
// What spans two points that move: springs, rods of distance links, ropes, belts.
import * as THREE from 'three';

import { geometryOf, inked, movePoints, sphere, unpicked } from './shapes.js';
import { theme } from './theme.js';

const Z = new THREE.Vector3(0, 0, 1);
const TURNS = 9;

// A coil of length 1 along z, with straight ends on the axis.
function coil(radius, wire) {
  const points = [new THREE.Vector3(0, 0, 0), new THREE.Vector3(0, 0, 0.1)];
  const n = TURNS * 14;
  for (let i = 0; i <= n; ++i) {
    const a = (i / n) * TURNS * 2 * Math.PI;
    points.push(new THREE.Vector3(radius * Math.cos(a), radius * Math.sin(a), 0.13 + (0.74 * i) / n));
  }
  points.push(new THREE.Vector3(0, 0, 0.9), new THREE.Vector3(0, 0, 1));
  return new THREE.TubeGeometry(new THREE.CatmullRomCurve3(points, false, 'catmullrom', 0.5), 14 * TURNS * 2, wire, 6);
}

// The marker objects of what is stretched, and its mesh of length 1 along z.
export class Stretched {
  constructor(data, world, unit) {
    this.mats = {
      spring: inked('spring', { metalness: 0.3 }),
      rod: inked('joint'),
      rope: theme.tinted('ink', new THREE.LineBasicMaterial()),
    };
    this.items = [];
    this.belts = [];
    const { links, forces } = data.mechanism;
    for (const force of forces)
      if (['spring_damper', 'bushing'].includes(force.type) && force.markers.length === 2)
        this.add(world, force.markers, new THREE.Mesh(coil(0.9 * unit, 0.13 * unit), this.mats.spring));
    links.forEach((link, number) => {
      if (link.belt) this.addBelt(world, link);
      if (link.type !== 'distance') return;
      const shape = new THREE.CylinderGeometry(0.3 * unit, 0.3 * unit, 1, 16).rotateX(Math.PI / 2).translate(0, 0, 0.5);
      const rod = new THREE.Mesh(shape, this.mats.rod);
      const rope = new THREE.Line(geometryOf([0, 0, 0, 0, 0, 1]), this.mats.rope);
      this.add(world, link.pairs[0], link.one_sided ? rope : rod, number);
      for (const m of link.pairs[0]) world.markers[m].add(sphere(0.6 * unit, this.mats.rod, 20));
    });
  }

  addBelt(world, link) {
    const lines = unpicked(new THREE.LineSegments(geometryOf(new Array(12).fill(0)), this.mats.rope));
    lines.frustumCulled = false;
    world.root.add(lines);
    this.belts.push({ markers: link.pairs.map(([p]) => world.markers[p]), lines, ...link.belt });
  }

  add(world, markers, mesh, link = -1) {
    const holder = new THREE.Group().add(unpicked(mesh));
    world.root.add(holder);
    this.items.push({ from: world.markers[markers[1]], to: world.markers[markers[0]], holder, link });
  }

  seek() {
    this.seekBelts();
    const along = new THREE.Vector3();
    for (const { from, to, holder } of this.items) {
      from.getWorldPosition(holder.position);
      to.getWorldPosition(along).sub(holder.position);
      const length = Math.max(along.length(), 1e-9);
      holder.quaternion.setFromUnitVectors(Z, along.divideScalar(length));
      holder.scale.set(1, 1, length);
    }
  }

  // The two straight parts of a belt: tangents of both pulleys, in the plane of the first.
  seekBelts() {
    for (const { markers, lines, radii, crossed } of this.belts) {
      const [a, b] = markers.map((m) => new THREE.Vector3().setFromMatrixPosition(m.matrixWorld));
      const axis = new THREE.Vector3().setFromMatrixColumn(markers[0].matrixWorld, 2);
      const along = new THREE.Vector3().subVectors(b, a),
        distance = along.length();
      along.divideScalar(distance || 1);
      const across = new THREE.Vector3().crossVectors(axis, along);
      const second = crossed ? -radii[1] : radii[1],
        cosine = (radii[0] - second) / distance,
        sine = Math.sqrt(Math.max(0, 1 - cosine * cosine));
      const ends = [];
      for (const side of [1, -1]) {
        const normal = along.clone().multiplyScalar(cosine);
        normal.addScaledVector(across, side * sine);
        ends.push(...a.clone().addScaledVector(normal, radii[0]), ...b.clone().addScaledVector(normal, second));
      }
      movePoints(lines, ends);
    }
  }

  show(link, shown) {
    for (const item of this.items) if (item.link === link) item.holder.visible = shown;
  }
}
