// SPDX-License-Identifier: BSD-3-Clause
// Envelope: of a long column the least and the largest value in each pixel, so that drawing stays fast.
import { indexAt } from './motion.js';

// Columns over x, reduced to about `pixels` pairs between from and to; short ones stay as they are. All share one x.
export function envelope(x, columns, from, to, pixels) {
  const first = indexAt(x, from),
    last = Math.min(x.length, indexAt(x, to) + 2),
    n = last - first;
  if (n <= 4 * pixels) return [x.slice(first, last), ...columns.map((y) => y.slice(first, last))];
  const run = Math.ceil(n / pixels);
  const buckets = Math.ceil(n / run);
  const out = [x, ...columns].map(() => new Float64Array(2 * buckets));
  for (let b = 0; b < buckets; ++b) {
    const i = first + b * run,
      end = Math.min(last, i + run);
    out[0][2 * b] = x[i];
    out[0][2 * b + 1] = x[(i + end - 1) >> 1];
    columns.forEach((y, c) => {
      let low = i,
        high = i;
      for (let k = i; k < end; ++k) {
        if (y[k] < y[low]) low = k;
        if (y[k] > y[high]) high = k;
      }
      out[c + 1][2 * b] = y[Math.min(low, high)];
      out[c + 1][2 * b + 1] = y[Math.max(low, high)];
    });
  }
  return out;
}
