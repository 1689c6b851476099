// SPDX-License-Identifier: BSD-3-Clause
// Grid: the ground of a mechanism in space, or the sheet behind one in a plane; fades out.
import { BufferAttribute, Color, LineBasicMaterial, LineSegments, Vector3 } from 'three';
import { roundDown } from './arrows.js';
import { geometryOf, unpicked } from './shapes.js';
import { theme } from './theme.js';

const FADE = 24; // pieces of a line

export class Grid {
  constructor(frame, unit) {
    const { plane, center, box, up, front, right } = frame;
    this.spacing = roundDown(frame.reach / 8);
    const planar = plane >= 0;
    const normal = planar ? front : up;
    const [e1, e2] = planar ? [right, up] : [right, front];
    // Below everything, or behind it.
    const corners = [box.min, box.max].map((p) => p.dot(normal));
    const level = Math.min(...corners) - (planar ? 3 * unit : 1.2 * unit);
    const snap = (e) => Math.round(center.dot(e) / this.spacing) * this.spacing;
    const origin = normal.clone().multiplyScalar(level);
    for (const e of [e1, e2]) origin.addScaledVector(e, snap(e));
    const n = Math.ceil(((planar ? 1.6 : 1.3) * frame.reach) / this.spacing);
    this.lines = unpicked(this.make(origin, e1, e2, n));
    this.recolor();
  }

  make(origin, e1, e2, n) {
    const numbers = [],
      alphas = [],
      p = new Vector3(),
      reach = n * this.spacing;
    const put = (a, b, c, d) => {
      p.copy(origin).addScaledVector(c, a * this.spacing);
      numbers.push(...p.addScaledVector(d, b * this.spacing));
      alphas.push(Math.max(0, 1 - (Math.hypot(a, b) * this.spacing) / reach) ** 1.5);
    };
    for (let i = -n; i <= n; ++i)
      for (const [c, d] of [[e1, e2], [e2, e1]])
        for (let k = 0; k < FADE; ++k) for (const end of [k, k + 1]) put(-n + (2 * n * end) / FADE, i, c, d);
    const geometry = geometryOf(numbers);
    this.alphas = alphas;
    geometry.setAttribute('color', new BufferAttribute(new Float32Array(4 * alphas.length), 4));
    const mat = new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false });
    return Object.assign(new LineSegments(geometry, mat), { renderOrder: -1 });
  }

  recolor() {
    const color = new Color(theme.is.grid),
      attribute = this.lines.geometry.getAttribute('color');
    this.alphas.forEach((alpha, i) => attribute.setXYZW(i, color.r, color.g, color.b, 0.75 * alpha));
    attribute.needsUpdate = true;
  }
}
