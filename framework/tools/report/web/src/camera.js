// SPDX-License-Identifier: BSD-3-Clause
// Views: a camera with perspective and one without, standard views, fit, and following a body.
import { OrthographicCamera, PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { extentOf } from './marks.js';

const FIELD = 30; // degrees, vertically: little distortion
const SLOPE = Math.tan((FIELD * Math.PI) / 360);

export class Views {
  constructor(frame, canvas, onChange) {
    Object.assign(this, { frame, canvas, onChange });
    const near = 1e-3 * frame.size,
      far = 200 * frame.reach;
    this.perspective = new PerspectiveCamera(FIELD, 1, near, far);
    this.orthographic = new OrthographicCamera(-1, 1, 1, -1, -far, far);
    this.aspect = 1;
    this.followed = null;
    this.fitted = true; // and not turned, moved or zoomed since
    this.use(frame.plane >= 0);
    this.look('home');
  }

  get isOrthographic() {
    return this.camera === this.orthographic;
  }

  use(orthographic) {
    const before = this.camera;
    this.camera = orthographic ? this.orthographic : this.perspective;
    this.camera.up.copy(this.frame.up);
    const target = this.controls ? this.controls.target.clone() : this.frame.center.clone();
    if (before && before !== this.camera) {
      this.camera.position.copy(before.position);
      const distance = before.position.distanceTo(target);
      if (orthographic) this.halfHeight = distance * SLOPE;
      else
        this.camera.position.sub(target).setLength(this.halfHeight / this.orthographic.zoom / SLOPE).add(target);
      this.orthographic.zoom = 1;
    }
    this.controls?.dispose();
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(target);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', this.onChange);
    this.controls.addEventListener('start', () => (this.fitted = false));
    this.project();
    this.update();
  }

  // After the camera was moved.
  update() {
    this.controls.update();
    this.onChange();
  }

  directionOf(view) {
    const { front, right, up, plane } = this.frame;
    const d = new Vector3();
    if (view === 'home') view = plane >= 0 ? 'front' : 'iso';
    if (view === 'front') return d.copy(front);
    if (view === 'right') return d.copy(right);
    if (view === 'top') return d.copy(up).addScaledVector(front, 1e-4); // not along "up" itself
    return d.copy(front).addScaledVector(right, 0.75).addScaledVector(up, 0.55);
  }

  look(view) {
    this.direction = this.directionOf(view).normalize();
    this.fit();
  }

  // All that moves fills the picture, seen from the present direction.
  fit() {
    const { frame } = this;
    this.fitted = true;
    const direction =
      this.direction ?? new Vector3().subVectors(this.camera.position, this.controls.target).normalize();
    this.direction = null;
    const side = new Vector3().crossVectors(frame.up, direction).normalize(),
      top = new Vector3().crossVectors(direction, side);
    const target = this.middle(side, top, direction);
    const margin = 0.07 * frame.size,
      v = new Vector3();
    let half = 0.25 * frame.size,
      distance = half / SLOPE;
    for (const p of frame.points) {
      v.subVectors(p, target);
      const across = Math.max(Math.abs(v.dot(top)) + margin, (Math.abs(v.dot(side)) + margin) / this.aspect) * 1.06;
      half = Math.max(half, across);
      distance = Math.max(distance, across / SLOPE + v.dot(direction));
    }
    this.halfHeight = half;
    this.orthographic.zoom = 1;
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, this.isOrthographic ? half / SLOPE : distance);
    this.project();
    this.update();
  }

  // The middle of all that moves, as it is seen along three axes.
  middle(...axes) {
    const target = new Vector3();
    for (const axis of axes) {
      const along = this.frame.points.map((p) => p.dot(axis));
      const [low, high] = extentOf(along, along.keys());
      target.addScaledVector(axis, 0.5 * (low + high));
    }
    return target;
  }

  resize(aspect) {
    this.aspect = aspect;
    this.project();
  }

  project() {
    this.perspective.aspect = this.aspect;
    this.perspective.updateProjectionMatrix();
    const top = this.halfHeight ?? this.frame.size,
      right = top * this.aspect;
    Object.assign(this.orthographic, { left: -right, right, top, bottom: -top });
    this.orthographic.updateProjectionMatrix();
  }

  // Turns the view about its target: angles to the right and upwards, rad.
  turn(right, up) {
    this.fitted = false;
    this.controls.rotateLeft(-right);
    this.controls.rotateUp(up);
  }

  // Moves the view by parts of its height, to the right and upwards.
  pan(right, up) {
    this.fitted = false;
    const height = 2 * this.metresPerPixel(2);
    this.shift(new Vector3(right * height, up * height, 0).applyQuaternion(this.camera.quaternion));
    this.onChange();
  }

  shift(step) {
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.controls.update();
  }

  zoom(factor) {
    this.fitted = false;
    this.controls.dollyIn(1 / factor);
  }

  // Keeps an object where it is in the picture; null: none.
  follow(object) {
    this.fitted = false;
    this.followed = object;
    this.at = object ? object.getWorldPosition(new Vector3()) : null;
  }

  moveAlong() {
    if (!this.followed) return;
    const now = this.followed.getWorldPosition(new Vector3());
    this.shift(now.clone().sub(this.at));
    this.at = now;
  }

  // Metres that a pixel at the target shows.
  metresPerPixel(height) {
    const half = this.isOrthographic
      ? this.halfHeight / this.orthographic.zoom
      : this.camera.position.distanceTo(this.controls.target) * SLOPE;
    return (2 * half) / height;
  }
}
