// SPDX-License-Identifier: BSD-3-Clause
// Badges: signs at joints that stand out, drawn over everything: redundant constraints, and joints that were deactivated.
import { CanvasTexture, Sprite, SpriteMaterial, SRGBColorSpace } from 'three';
import { make } from './dom.js';
import { unpicked } from './shapes.js';

const PIXELS = 96;

function texture(paint) {
  const canvas = make('canvas', undefined, { width: PIXELS, height: PIXELS });
  const ctx = canvas.getContext('2d');
  ctx.scale(PIXELS, PIXELS);
  ctx.lineCap = ctx.lineJoin = 'round';
  paint(ctx);
  return Object.assign(new CanvasTexture(canvas), { colorSpace: SRGBColorSpace });
}

// A way as SVG has it, in a picture of size 1.
function draw(ctx, way, color, width, fill = 'transparent') {
  Object.assign(ctx, { strokeStyle: color, lineWidth: width, fillStyle: fill });
  ctx.fill(new Path2D(way));
  ctx.stroke(new Path2D(way));
}

// A triangle with an exclamation mark.
function paintWarning(ctx) {
  draw(ctx, 'M0.5 0.12 L0.92 0.84 L0.08 0.84 Z', '#1c2530', 0.06, '#e69f00');
  draw(ctx, 'M0.5 0.38 V0.58 M0.5 0.72 V0.721', '#1c2530', 0.09);
}

// A cross with a light edge.
function paintCross(ctx) {
  const way = 'M0.22 0.22 L0.78 0.78 M0.78 0.22 L0.22 0.78';
  draw(ctx, way, '#ffffff', 0.3);
  draw(ctx, way, '#b3261e', 0.17);
}

export class Badges {
  constructor(data, world, unit) {
    const of = (paint) => new SpriteMaterial({ map: texture(paint), depthTest: false, transparent: true });
    this.mats = { warning: of(paintWarning), cross: of(paintCross) };
    const why = new Map(data.text.marked ?? []);
    this.links = data.mechanism.links.map((link) => {
      const marked = why.has(link.name);
      const ends = link.pairs.length > 0 ? link.pairs[0] : [];
      // Beside the symbol of the joint, which it would hide.
      const warnings = marked ? ends.slice(1).map((m) => this.sprite('warning', world.markers[m], 3 * unit, -0.35)) : [];
      const crosses = ends.map((m) => this.sprite('cross', world.markers[m], 2.4 * unit, 0.5));
      return { warnings, crosses };
    });
  }

  sprite(kind, marker, size, center) {
    const sprite = unpicked(new Sprite(this.mats[kind]));
    sprite.center.set(center, center);
    sprite.scale.setScalar(size);
    Object.assign(sprite, { renderOrder: 10, visible: kind === 'warning' });
    marker.add(sprite);
    return sprite;
  }

  // `state`: 'holds', 'idle' before it ever held, or 'off' after it was deactivated.
  show(link, state) {
    for (const sprite of this.links[link].warnings) sprite.visible = state === 'holds';
    for (const sprite of this.links[link].crosses) sprite.visible = state === 'off';
  }
}
