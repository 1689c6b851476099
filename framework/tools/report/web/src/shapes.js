// SPDX-License-Identifier: BSD-3-Clause
// Shapes: geometry made of a few solids, with thin edges that keep forms apart.
import * as THREE from 'three';
import { theme } from './theme.js';

const Y = new THREE.Vector3(0, 1, 0),
  Z = new THREE.Vector3(0, 0, 1);

// Parts of the same size share one geometry: a chain has a hundred of them.
const made = new Map();
function shared(make, ...numbers) {
  const key = `${make.name} ${numbers.map((n) => n.toPrecision(6))}`;
  if (!made.has(key)) made.set(key, make(...numbers));
  return made.get(key);
}

const boxOf = (x, y, z) => new THREE.BoxGeometry(x, y, z);
const cylinderOf = (radius, length, sides) => new THREE.CylinderGeometry(radius, radius, length, sides);
const capsuleOf = (radius, length) => new THREE.CapsuleGeometry(radius, length, 6, 20);
const sphereOf = (radius, across, down) => new THREE.SphereGeometry(radius, across, down);
const edgesOf = new Map(); // of a geometry

export function material(color, options = {}) {
  return new THREE.MeshStandardMaterial({ color, roughness: 0.55, metalness: 0.05, ...options });
}

// In a colour of the theme, with which it changes.
export const inked = (name, options) => theme.tinted(name, material(theme.is[name], options));

// What a click passes through.
export const unpicked = (object) => Object.assign(object, { raycast: () => {} });

// Turns an object whose axis is z so that it is the axis k.
export function along(object, k) {
  if (k === 0) object.rotation.set(0, Math.PI / 2, 0);
  if (k === 1) object.rotation.set(-Math.PI / 2, 0, 0);
  return object;
}

export function edges(geometry, color) {
  if (!edgesOf.has(geometry)) edgesOf.set(geometry, new THREE.EdgesGeometry(geometry, 40));
  const mat = new THREE.LineBasicMaterial({ color, transparent: true, opacity: 0.35 });
  return unpicked(new THREE.LineSegments(edgesOf.get(geometry), mat));
}

export function box(size, mat, edgeColor) {
  const geometry = shared(boxOf, ...size);
  const mesh = new THREE.Mesh(geometry, mat);
  mesh.add(edges(geometry, edgeColor));
  return mesh;
}

// Along z.
export function cylinder(radius, length, mat, edgeColor, sides = 40) {
  const geometry = shared(cylinderOf, radius, length, sides);
  const mesh = new THREE.Mesh(geometry, mat);
  mesh.rotation.x = Math.PI / 2;
  if (edgeColor) mesh.add(edges(geometry, edgeColor));
  return new THREE.Group().add(mesh);
}

export function sphere(radius, mat, detail = 32) {
  return new THREE.Mesh(shared(sphereOf, radius, detail, detail >> 1), mat);
}

// A bar with round ends.
export function bar(from, to, radius, mat) {
  const along = new THREE.Vector3().subVectors(to, from);
  const length = along.length();
  const mesh = new THREE.Mesh(shared(capsuleOf, radius, length), mat);
  if (length > 1e-9) mesh.quaternion.setFromUnitVectors(Y, along.divideScalar(length));
  mesh.position.addVectors(from, to).multiplyScalar(0.5);
  return mesh;
}

// The flat area of points in the plane with this normal, as a thin sheet.
export function plate(points, normal, mat) {
  const turn = new THREE.Quaternion().setFromUnitVectors(normal, Z);
  const flat = points.map((p) => p.clone().applyQuaternion(turn));
  const mesh = new THREE.Mesh(new THREE.ShapeGeometry(new THREE.Shape(flat)), mat);
  mesh.quaternion.copy(turn).invert();
  mesh.position.copy(new THREE.Vector3(0, 0, flat[0].z).applyQuaternion(mesh.quaternion));
  return mesh;
}

// The engineer's mark of a centre of mass: a ball in quarters.
export function centerMark(radius) {
  const mat = new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.7 });
  return new THREE.Mesh(shared(quarters, radius), mat);
}

function quarters(radius) {
  const geometry = new THREE.SphereGeometry(radius, 24, 16).toNonIndexed();
  const at = geometry.getAttribute('position');
  const colors = new Float32Array(3 * at.count);
  const [a, b] = [new THREE.Color('#15181c'), new THREE.Color('#f4f4f4')];
  for (let i = 0; i < at.count; i += 3) {
    const mean = [0, 1, 2].map((c) => at.getComponent(i, c) + at.getComponent(i + 1, c) + at.getComponent(i + 2, c));
    const color = mean[0] * mean[1] * mean[2] > 0 ? a : b;
    for (let k = 0; k < 3; ++k) color.toArray(colors, 3 * (i + k));
  }
  geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
  return geometry;
}

// A tube along points x y z, x y z, ...
export function tube(numbers, closed, radius, mat) {
  const points = [];
  for (let i = 0; i < numbers.length; i += 3) points.push(new THREE.Vector3().fromArray(numbers, i));
  const curve = new THREE.CatmullRomCurve3(points, closed);
  return new THREE.Mesh(new THREE.TubeGeometry(curve, 2 * points.length, radius, 8, closed), mat);
}

// Points x y z, x y z, ... as a geometry.
export function geometryOf(numbers) {
  return new THREE.BufferGeometry().setAttribute('position', new THREE.BufferAttribute(Float32Array.from(numbers), 3));
}

// Other places for the points of a line.
export function movePoints({ geometry }, numbers) {
  const position = geometry.getAttribute('position');
  position.array.set(numbers);
  position.needsUpdate = true;
}
