// SPDX-License-Identifier: BSD-3-Clause
// A table from CSV text: quoted cells may hold commas, line ends and doubled quotes.

function cells(text) {
  const rows = [[]];
  let cell = '',
    quoted = false;
  const end = () => {
    rows[rows.length - 1].push(cell);
    cell = '';
  };
  for (let i = 0; i < text.length; ++i) {
    const c = text[i];
    if (quoted) {
      if (c !== '"') cell += c;
      else if (text[i + 1] === '"') cell += text[++i];
      else quoted = false;
    } else if (c === '"') quoted = true;
    else if (c === ',') end();
    else if (c === '\n') {
      end();
      rows.push([]);
    } else if (c !== '\r') cell += c;
  }
  if (cell !== '' || rows[rows.length - 1].length > 0) end();
  return rows.filter((row) => row.length > 0);
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
