// SPDX-License-Identifier: BSD-3-Clause
// Freedoms: what the mask of a joint leaves free.

const AXES = ['x', 'y', 'z'];

// What the rows of a mask leave free: axes of translation and of rotation, 0 1 2.
export function freedoms(mask) {
  const rows = new Set(mask.split(' '));
  return {
    slides: [0, 1, 2].filter((k) => !rows.has(AXES[k])),
    turns: [0, 1, 2].filter((k) => !rows.has(`e${k + 1}`)),
  };
}
