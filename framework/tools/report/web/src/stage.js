// SPDX-License-Identifier: BSD-3-Clause
// Stage: the picture of the mechanism, drawn when something changed.
import * as THREE from 'three';
import { Views } from './camera.js';
import { Grid } from './grid.js';
import { Overlay } from './overlay.js';
import { theme } from './theme.js';

export class Stage {
  constructor(data, world, elements) {
    Object.assign(this, { world, elements });
    this.scene = new THREE.Scene();
    this.renderer = new THREE.WebGLRenderer({ canvas: elements.canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.grid = new Grid(world.frame, world.unit);
    this.views = new Views(world.frame, elements.canvas, () => this.redraw());
    this.overlay = new Overlay(data, world, elements);
    // Light comes over the viewer's left shoulder, from wherever he looks.
    this.key = new THREE.DirectionalLight('#ffffff', 2.1);
    this.scene.add(
      world.root,
      this.grid.lines,
      this.key,
      this.key.target,
      new THREE.HemisphereLight('#ffffff', '#b0b7c0', 1.4),
      new THREE.AmbientLight('#ffffff', 0.5),
    );
    this.recolor();
    new ResizeObserver(() => this.resize()).observe(elements.stage);
    this.resize();
    this.views.fit();
  }

  resize() {
    const { clientWidth, clientHeight } = this.elements.stage;
    if (clientWidth === 0 || clientHeight === 0) return;
    const first = this.width === undefined;
    Object.assign(this, { width: clientWidth, height: clientHeight });
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.views.resize(clientWidth / clientHeight);
    if (first) this.views.look('home');
    else if (this.views.fitted) this.views.fit();
    this.render();
  }

  redraw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.render());
  }

  render() {
    this.asked = false;
    if (this.width === undefined) return;
    const { camera, controls } = this.views;
    this.views.moveAlong();
    camera.updateMatrixWorld();
    this.key.position.copy(controls.target).add(new THREE.Vector3(-0.5, 0.9, 1).applyQuaternion(camera.quaternion));
    this.key.target.position.copy(controls.target);
    this.renderer.render(this.scene, camera);
    this.overlay.draw(camera, this.width, this.height, this.views.metresPerPixel(this.height));
  }

  // The body under a point of the canvas; -1: none.
  pick(x, y) {
    const ray = new THREE.Raycaster(),
      at = new THREE.Vector2((2 * x) / this.width - 1, 1 - (2 * y) / this.height);
    ray.setFromCamera(at, this.views.camera);
    for (const hit of ray.intersectObject(this.world.root, true)) {
      let object = hit.object;
      while (object && object.userData.body === undefined) object = object.parent;
      if (object) return object.userData.body;
    }
    return -1;
  }

  recolor() {
    this.scene.background = new THREE.Color(theme.is.background);
    this.world.recolor();
    this.grid.recolor();
    this.redraw();
  }
}
