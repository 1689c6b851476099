// SPDX-License-Identifier: BSD-3-Clause
// Meshes: surfaces of triangles, whose points are whole numbers of their extent.
import { BufferAttribute, BufferGeometry, EdgesGeometry, LineBasicMaterial, LineSegments, Mesh } from 'three';

const WHOLE = 65535;
const MOST_EDGES = 20000; // triangles, beyond which edges are not looked for

// The points of a mesh, with a factor along each axis.
export function pointsOf(mesh, factors) {
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
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(pointsOf(mesh, factors), 3));
      geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
      const edges = mesh.triangles.length < 3 * MOST_EDGES ? new EdgesGeometry(geometry, 40) : null;
      this.made.set(key, { geometry, edges });
    }
    return this.made.get(key);
  }

  object(number, factors, mat, edgeColor) {
    const { geometry, edges } = this.geometry(number, factors);
    const object = new Mesh(geometry, mat);
    if (edges) {
      const lines = new LineSegments(edges, new LineBasicMaterial({ color: edgeColor, transparent: true, opacity: 0.35 }));
      lines.raycast = () => {};
      object.add(lines);
    }
    return object;
  }
}
