// SPDX-License-Identifier: BSD-3-Clause
// The data of the page: a description as JSON, and numbers as base64.

function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

// An array of the block; a column with a base holds differences from it.
function arrayAt(buffer, place) {
  if (place.whole) {
    const Kind = place.bits === 16 ? Uint16Array : Uint32Array;
    return new Kind(buffer, place.at, place.n);
  }
  const values =
    place.bits === 64 ? new Float64Array(buffer, place.at, place.n) : new Float32Array(buffer, place.at, place.n);
  if (!place.base) return values;
  return Float64Array.from(values, (v) => v + place.base);
}

function readFrames(buffer, frames) {
  frames.times = arrayAt(buffer, frames.times);
  frames.rows = arrayAt(buffer, frames.rows);
}

function readTable(buffer, table) {
  for (const column of table.columns) column.values = arrayAt(buffer, column.values);
}

function readMeshes(buffer, meshes) {
  for (const mesh of meshes) {
    mesh.points = arrayAt(buffer, mesh.points);
    mesh.triangles = arrayAt(buffer, mesh.triangles);
  }
}

const element = (id) => document.getElementById(id);

export function readData() {
  const data = JSON.parse(element('data').textContent);
  const text = element('numbers').textContent.trim();
  element('numbers').textContent = '';
  const buffer = bytesOf(text).buffer;
  if (data.kind === 'points') {
    if (!data.histories) return data;
    readMeshes(buffer, data.histories.meshes);
    for (const run of data.histories.runs) {
      readTable(buffer, run.table);
      if (run.frames) readFrames(buffer, run.frames);
    }
    return data;
  }
  readFrames(buffer, data.frames);
  readTable(buffer, data.table);
  readMeshes(buffer, data.meshes);
  return data;
}
