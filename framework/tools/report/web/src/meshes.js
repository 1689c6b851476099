// SPDX-License-Identifier: BSD-3-Clause
// Meshes: surfaces of triangles, whose points are whole numbers of their extent.
import { BufferAttribute, Mesh } from 'three';
import { edges, geometryOf } from './shapes.js';

const WHOLE = 65535;
const MOST_EDGES = 20000; // triangles, beyond which edges are not looked for

// The points of a mesh, with a factor along each axis.
function pointsOf(mesh, factors) {
  return Float32Array.from(mesh.points, (v, i) => {
    const k = i % 3;
    return factors[k] * (mesh.low[k] + (mesh.size[k] * v) / WHOLE);
  });
}

// The corners of its box.
export function* cornersOf(mesh, factors) {
  for (let c = 0; c < 8; ++c)
    yield factors.map((f, k) => f * (mesh.low[k] + ((c >> k) & 1 ? mesh.size[k] : 0)));
}

export class Meshes {
  constructor(list) {
    this.list = list;
    this.made = new Map(); // geometries by number and factors
  }

  geometry(number, factors) {
    const key = `${number} ${factors}`;
    if (!this.made.has(key)) {
      const mesh = this.list[number];
      const geometry = geometryOf(pointsOf(mesh, factors));
      this.made.set(key, geometry.setIndex(new BufferAttribute(mesh.triangles, 1)));
    }
    return this.made.get(key);
  }

  object(number, factors, mat, edgeColor) {
    const geometry = this.geometry(number, factors);
    const object = new Mesh(geometry, mat);
    if (this.list[number].triangles.length < 3 * MOST_EDGES) object.add(edges(geometry, edgeColor));
    return object;
  }
}
