// SPDX-License-Identifier: BSD-3-Clause
// The data of the page: a description as JSON, and numbers as base64.
import { byId } from './dom.js';

function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

// An array of the block; a column with a base holds differences from it.
function arrayAt(buffer, { at, n, bits, whole, base }) {
  const Kind = whole ? { 16: Uint16Array, 32: Uint32Array }[bits] : { 32: Float32Array, 64: Float64Array }[bits];
  const values = new Kind(buffer, at, n);
  return base ? Float64Array.from(values, (v) => v + base) : values;
}

// Puts the arrays in the places of their descriptions.
function readArrays(buffer, object, ...keys) {
  for (const key of keys) object[key] = arrayAt(buffer, object[key]);
}

export function readData() {
  const data = JSON.parse(byId('data').textContent);
  const { buffer } = bytesOf(byId('numbers').textContent.trim());
  byId('numbers').textContent = '';
  if (data.kind === 'points' && !data.histories) return data;
  const { meshes, runs = [data] } = data.histories ?? data;
  for (const mesh of meshes) readArrays(buffer, mesh, 'points', 'triangles');
  for (const { table, frames } of runs) {
    for (const column of table.columns) readArrays(buffer, column, ...(column.curve ? ['values', 'curve'] : ['values']));
    if (frames) readArrays(buffer, frames, 'times', 'rows');
  }
  return data;
}
