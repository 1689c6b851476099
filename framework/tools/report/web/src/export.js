// SPDX-License-Identifier: BSD-3-Clause
// Files that the reader saves.
import { make } from './dom.js';
import { theme } from './theme.js';

export function download(name, blob) {
  const link = make('a', undefined, { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export const saveCsv = (name, text) => download(name, new Blob([text], { type: 'text/csv' }));

// A plot with its legend, on the page's ground.
export function pngOf(plot, name) {
  const from = plot.ctx.canvas,
    scale = devicePixelRatio,
    top = 26 * scale;
  const canvas = make('canvas', undefined, { width: from.width, height: from.height + top });
  const ctx = canvas.getContext('2d');
  ctx.fillStyle = theme.is.dark ? '#1a2028' : '#ffffff';
  ctx.fillRect(0, 0, canvas.width, canvas.height);
  ctx.drawImage(from, 0, top);
  ctx.font = `${12 * scale}px system-ui, sans-serif`;
  let x = 12 * scale;
  for (const series of plot.series.slice(1)) {
    if (!series.show || !series.label) continue;
    ctx.fillStyle = series.stroke();
    ctx.fillRect(x, 12 * scale, 16 * scale, 2.5 * scale);
    ctx.fillStyle = theme.is.ink;
    ctx.fillText(series.label, x + 20 * scale, 17 * scale);
    x += 34 * scale + ctx.measureText(series.label).width;
  }
  canvas.toBlob((blob) => download(name, blob));
}
