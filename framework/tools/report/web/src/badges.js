// SPDX-License-Identifier: BSD-3-Clause
// Badges: signs at links that stand out, drawn over everything: redundant rows, and links that were switched off.
import { CanvasTexture, Sprite, SpriteMaterial, SRGBColorSpace } from 'three';

const PIXELS = 96;

function texture(paint) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = PIXELS;
  const ctx = canvas.getContext('2d');
  ctx.lineCap = ctx.lineJoin = 'round';
  paint(ctx, PIXELS);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  return map;
}

// A triangle with an exclamation mark.
function paintWarning(ctx, n) {
  ctx.beginPath();
  ctx.moveTo(0.5 * n, 0.12 * n);
  ctx.lineTo(0.92 * n, 0.84 * n);
  ctx.lineTo(0.08 * n, 0.84 * n);
  ctx.closePath();
  ctx.fillStyle = '#e69f00';
  ctx.strokeStyle = '#1c2530';
  ctx.lineWidth = 0.06 * n;
  ctx.fill();
  ctx.stroke();
  ctx.lineWidth = 0.09 * n;
  ctx.beginPath();
  ctx.moveTo(0.5 * n, 0.38 * n);
  ctx.lineTo(0.5 * n, 0.58 * n);
  ctx.moveTo(0.5 * n, 0.72 * n);
  ctx.lineTo(0.5 * n, 0.721 * n);
  ctx.stroke();
}

// A cross with a light edge.
function paintCross(ctx, n) {
  for (const [color, width] of [
    ['#ffffff', 0.3],
    ['#b3261e', 0.17],
  ]) {
    ctx.strokeStyle = color;
    ctx.lineWidth = width * n;
    ctx.beginPath();
    ctx.moveTo(0.22 * n, 0.22 * n);
    ctx.lineTo(0.78 * n, 0.78 * n);
    ctx.moveTo(0.78 * n, 0.22 * n);
    ctx.lineTo(0.22 * n, 0.78 * n);
    ctx.stroke();
  }
}

export class Badges {
  constructor(data, world, unit) {
    const of = (paint) => new SpriteMaterial({ map: texture(paint), depthTest: false, transparent: true });
    this.mats = { warning: of(paintWarning), cross: of(paintCross) };
    const why = new Map(data.text.marked ?? []);
    this.links = data.mechanism.links.map((link) => {
      const marked = why.has(link.name);
      const ends = link.pairs.length > 0 ? link.pairs[0] : [];
      // Beside the symbol of the link, which it would hide.
      const warnings = marked ? ends.slice(1).map((m) => this.sprite('warning', world.markers[m], 3 * unit, -0.35)) : [];
      const crosses = ends.map((m) => this.sprite('cross', world.markers[m], 2.4 * unit, 0.5));
      return { warnings, crosses };
    });
  }

  sprite(kind, marker, size, center) {
    const sprite = new Sprite(this.mats[kind]);
    sprite.center.set(center, center);
    sprite.scale.setScalar(size);
    sprite.renderOrder = 10;
    sprite.raycast = () => {};
    sprite.visible = kind === 'warning';
    marker.add(sprite);
    return sprite;
  }

  // `state`: 'holds', 'idle' before it ever held, or 'off' after it was switched off.
  show(link, state) {
    for (const sprite of this.links[link].warnings) sprite.visible = state === 'holds';
    for (const sprite of this.links[link].crosses) sprite.visible = state === 'off';
  }
}
