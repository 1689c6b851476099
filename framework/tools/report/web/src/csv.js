// SPDX-License-Identifier: BSD-3-Clause
// A table from CSV text: quoted cells may hold commas, line ends and doubled quotes.

const CELL = /(?:"((?:[^"]|"")*)"|([^,\n]*?))(,|\r?\n|$)/g;

function cells(text) {
  const rows = [[]];
  for (const [, quoted, plain, end] of text.matchAll(CELL)) {
    rows.at(-1).push(quoted?.replaceAll('""', '"') ?? plain);
    if (end !== ',') rows.push([]);
  }
  return rows.filter((row) => row.length > 1 || row[0]);
}

// Columns with their titles; those of numbers alone, with NaN for an empty cell, have `numbers`.
export function readTable(text) {
  const [titles, ...rows] = cells(text);
  return {
    rows,
    columns: titles.map((title, k) => {
      const texts = rows.map((row) => row[k] ?? '');
      const numbers = texts.map((t) => (t.trim() === '' ? NaN : Number(t)));
      const numeric =
        texts.some((t) => t.trim() !== '') &&
        texts.every((t, i) => t.trim() === '' || t === 'nan' || !Number.isNaN(numbers[i]));
      return { title, texts, numbers: numeric ? numbers : null };
    }),
  };
}
