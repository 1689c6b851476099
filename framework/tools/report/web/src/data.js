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
  const values =
    place.bits === 64 ? new Float64Array(buffer, place.at, place.n) : new Float32Array(buffer, place.at, place.n);
  if (!place.base) return values;
  return Float64Array.from(values, (v) => v + place.base);
}

const element = (id) => document.getElementById(id);

export function readData() {
  const data = JSON.parse(element('data').textContent);
  if (data.kind === 'points') return data;
  const buffer = bytesOf(element('numbers').textContent.trim()).buffer;
  element('numbers').textContent = '';
  data.frames.times = arrayAt(buffer, data.frames.times);
  data.frames.rows = arrayAt(buffer, data.frames.rows);
  for (const column of data.table.columns) column.values = arrayAt(buffer, column.values);
  return data;
}
