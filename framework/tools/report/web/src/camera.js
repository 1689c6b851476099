// Views: a camera with perspective and one without, standard views, fit, and following a body.
import { OrthographicCamera, PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const FIELD = 30;  // degrees, vertically: little distortion

export class Views {
  constructor(frame, canvas, onChange) {
    this.frame = frame;
    this.canvas = canvas;
    this.onChange = onChange;
    const near = 1e-3 * frame.size, far = 200 * frame.reach;
    this.perspective = new PerspectiveCamera(FIELD, 1, near, far);
    this.orthographic = new OrthographicCamera(-1, 1, 1, -1, -far, far);
    this.aspect = 1;
    this.followed = null;
    this.use(frame.plane >= 0);
    this.look('home');
  }

  get isOrthographic() { return this.camera === this.orthographic; }

  use(orthographic) {
    const before = this.camera;
    this.camera = orthographic ? this.orthographic : this.perspective;
    this.camera.up.copy(this.frame.up);
    const target = this.controls ? this.controls.target.clone() : this.frame.center.clone();
    if (before && before !== this.camera) {
      this.camera.position.copy(before.position);
      const distance = before.position.distanceTo(target);
      if (orthographic) this.halfHeight = distance * Math.tan((FIELD * Math.PI) / 360);
      else {
        const wanted = this.halfHeight / this.orthographic.zoom / Math.tan((FIELD * Math.PI) / 360);
        this.camera.position.sub(target).setLength(wanted).add(target);
      }
      this.orthographic.zoom = 1;
    }
    this.controls?.dispose();
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(target);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', this.onChange);
    this.project();
    this.controls.update();
    this.onChange();
  }

  directionOf(view) {
    const { front, right, up, plane } = this.frame;
    const d = new Vector3();
    if (view === 'home') view = plane >= 0 ? 'front' : 'iso';
    if (view === 'front') return d.copy(front);
    if (view === 'right') return d.copy(right);
    if (view === 'top') return d.copy(up).addScaledVector(front, 1e-4);  // not along "up" itself
    return d.copy(front).addScaledVector(right, 0.75).addScaledVector(up, 0.55);
  }

  look(view) {
    this.direction = this.directionOf(view).normalize();
    this.fit();
  }

  // All that moves fills the picture, seen from the present direction.
  fit() {
    const { frame } = this;
    const direction = this.direction ?? new Vector3().subVectors(this.camera.position, this.controls.target).normalize();
    this.direction = null;
    const side = new Vector3().crossVectors(frame.up, direction).normalize(), top = new Vector3().crossVectors(direction, side);
    const target = frame.center.clone();
    let wide = 0, high = 0, deep = 0;
    const corner = new Vector3();
    for (let c = 0; c < 8; ++c) {
      corner.set(c & 1 ? frame.box.max.x : frame.box.min.x, c & 2 ? frame.box.max.y : frame.box.min.y, c & 4 ? frame.box.max.z : frame.box.min.z).sub(target);
      wide = Math.max(wide, Math.abs(corner.dot(side)));
      high = Math.max(high, Math.abs(corner.dot(top)));
      deep = Math.max(deep, Math.abs(corner.dot(direction)));
    }
    const margin = 0.06 * frame.size;
    this.halfHeight = Math.max(high + margin, (wide + margin) / this.aspect, 0.1 * frame.size) * 1.12;
    this.orthographic.zoom = 1;
    const distance = this.halfHeight / Math.tan((FIELD * Math.PI) / 360) + (this.isOrthographic ? 0 : 0.6 * deep);
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.project();
    this.controls.update();
    this.onChange();
  }

  resize(aspect) {
    this.aspect = aspect;
    this.project();
  }

  project() {
    this.perspective.aspect = this.aspect;
    this.perspective.updateProjectionMatrix();
    const h = this.halfHeight ?? this.frame.size, o = this.orthographic;
    o.left = -h * this.aspect;
    o.right = h * this.aspect;
    o.top = h;
    o.bottom = -h;
    o.updateProjectionMatrix();
  }

  // Keeps an object where it is in the picture; null: none.
  follow(object) {
    this.followed = object;
    this.at = object ? object.getWorldPosition(new Vector3()) : null;
  }

  moveAlong() {
    if (!this.followed) return;
    const now = this.followed.getWorldPosition(new Vector3());
    const step = now.clone().sub(this.at);
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.controls.update();
    this.at = now;
  }

  // Metres that a pixel at the target shows.
  metresPerPixel(height) {
    const half = this.isOrthographic ? this.halfHeight / this.orthographic.zoom
      : this.camera.position.distanceTo(this.controls.target) * Math.tan((FIELD * Math.PI) / 360);
    return (2 * half) / height;
  }
}
