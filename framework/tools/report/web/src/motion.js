// SPDX-License-Identifier: BSD-3-Clause
// Motion: poses and loads at any time, between the frames by cubic polynomials through poses and velocities.

import { Quaternion } from 'three';

const BODY = 13,
  MARKER = 7,
  LOAD = 6;

// The last index k with times[k] <= t; at least 0.
export function indexAt(times, t) {
  let low = 0,
    high = times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  return low;
}

// Weights of the two values and of the two rates, for a step h and u = 0..1 in it.
function weights(u, h) {
  const v = 1 - u;
  return [v * v * (1 + 2 * u), u * u * (3 - 2 * u), u * v * v * h, -u * u * v * h];
}

// Puts a quaternion at a place, with length 1.
const putTurn = (to, at, e) => new Quaternion(...e).normalize().toArray(to, at);

export class Motion {
  constructor(data) {
    const { frames, mechanism } = data;
    this.times = frames.times;
    this.rows = frames.rows;
    this.width = frames.width;
    this.jumps = new Set(frames.jumps);
    this.nBodies = mechanism.moving.length;
    this.nMarkers = mechanism.moved_markers.length;
    this.nLoads = mechanism.loads.length;
    // x y z, then the quaternion x y z w as three.js has it
    this.bodies = new Float64Array(7 * this.nBodies);
    this.markers = new Float64Array(7 * this.nMarkers);
    this.loads = new Float64Array(LOAD * this.nLoads);
    this.velocities = new Float64Array(6 * this.nBodies);
    this.t = NaN;
  }

  get start() {
    return this.times[0];
  }
  get end() {
    return this.times[this.times.length - 1];
  }

  seek(t) {
    if (t === this.t) return;
    this.t = t;
    const { times } = this;
    const k = indexAt(times, t);
    const next = Math.min(k + 1, times.length - 1);
    const h = times[next] - times[k];
    const u = h > 0 ? Math.min(1, Math.max(0, (t - times[k]) / h)) : 0;
    // Velocities at the end are those after a jump, unless the frame before it is kept as well.
    const endIsAfterJump = this.jumps.has(next) && h > 0;
    for (let i = 0; i < this.nBodies; ++i) this.seekBody(i, k, next, u, h, endIsAfterJump);
    for (let i = 0; i < this.nMarkers; ++i) this.seekMarker(i, k, next, u);
    const first = BODY * this.nBodies + MARKER * this.nMarkers;
    const a = k * this.width + first,
      b = next * this.width + first;
    for (let i = 0; i < this.loads.length; ++i) this.loads[i] = (1 - u) * this.rows[a + i] + u * this.rows[b + i];
  }

  seekBody(i, k, next, u, h, endIsAfterJump) {
    const { rows, bodies, velocities } = this;
    const a = k * this.width + BODY * i,
      b = next * this.width + BODY * i,
      out = 7 * i;
    const [p, q, r, s] = weights(u, h);
    for (let c = 0; c < 3; ++c) {
      const end = endIsAfterJump ? (rows[b + c] - rows[a + c]) / h : rows[b + 7 + c];
      bodies[out + c] = p * rows[a + c] + q * rows[b + c] + r * rows[a + 7 + c] + s * end;
    }
    for (let c = 0; c < 6; ++c) velocities[6 * i + c] = (1 - u) * rows[a + 7 + c] + u * rows[b + 7 + c];
    this.turn(a, b, [p, q, r, s], endIsAfterJump ? h : 0, out + 3);
  }

  // The quaternion, whose rate is half the angular velocity times itself.
  turn(a, b, [p, q, r, s], secant, out) {
    const { rows, bodies } = this;
    const [q0, q1] = this.turnsOf(a, b);
    const rate = (at, e) => {
      const w = new Quaternion(rows[at + 10], rows[at + 11], rows[at + 12], 0);
      return [...w.multiply(new Quaternion(...e))].map((c) => 0.5 * c);
    };
    const d0 = rate(a, q0),
      d1 = secant ? q1.map((c, i) => (c - q0[i]) / secant) : rate(b, q1);
    const between = q0.map((c, i) => p * c + q * q1[i] + r * d0[i] + s * d1[i]);
    putTurn(bodies, out, between);
  }

  // The quaternions of two poses, on the same side; scalar last, which is first in the frames.
  turnsOf(a, b) {
    const [q0, q1] = [a, b].map((at) => [4, 5, 6, 3].map((c) => this.rows[at + c]));
    return [q0, q0.reduce((sum, c, i) => sum + c * q1[i], 0) < 0 ? q1.map((c) => -c) : q1];
  }

  seekMarker(i, k, next, u) {
    const { rows, markers } = this;
    const first = BODY * this.nBodies + MARKER * i;
    const a = k * this.width + first,
      b = next * this.width + first,
      out = 7 * i;
    for (let c = 0; c < 3; ++c) markers[out + c] = (1 - u) * rows[a + c] + u * rows[b + c];
    const [q0, q1] = this.turnsOf(a, b);
    const between = q0.map((c, j) => (1 - u) * c + u * q1[j]);
    putTurn(markers, out + 3, between);
  }
}
