// SPDX-License-Identifier: BSD-3-Clause
// Theme: the colours of the PNG charts, and what light and dark need beside them.

// Okabe and Ito, as in the charts; the last one is ink.
const PALETTE = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];
const PALETTE_DARK = ['#3a9bdc', '#f0793a', '#2bbd94', '#dd94bd', '#f0b53c', '#7cc6f2'];

// In light and in dark.
const COLORS = {
  background: ['#f7f8fa', '#12161c'],
  ink: ['#1c2530', '#e8edf3'],
  soft: ['#5a6573', '#a3afbd'],
  line: ['#c9d0d8', '#38424f'],
  grid: ['#b9c3cf', '#3d4957'],
  joint: ['#3c4754', '#c3ccd6'],
  pin: ['#ffffff', '#12161c'],
  ground: ['#8a95a1', '#7d8894'],
  drive: ['#d55e00', '#f0793a'],
  force: ['#c2410c', '#ff8f5a'],
  moment: ['#7b3fa0', '#c79be6'],
  reaction: ['#00684c', '#3ed0a3'],
  spring: ['#6b5a1e', '#d9c173'],
  plotGrid: ['#e3e7ec', '#262e38'],
};
const [LIGHT, DARK] = [0, 1].map((k) => ({
  dark: k === 1,
  ...Object.fromEntries(Object.entries(COLORS).map(([name, pair]) => [name, pair[k]])),
}));

const query = matchMedia('(prefers-color-scheme: dark)');

export const theme = {
  get is() {
    return query.matches ? DARK : LIGHT;
  },
  // The n-th colour; after six the ink.
  color(n) {
    return n % 7 === 6 ? this.is.ink : this.bodyColor(n % 7);
  },
  // Colours of bodies: without ink, which is for joints.
  bodyColor(n) {
    return (query.matches ? PALETTE_DARK : PALETTE)[n % 6];
  },
  onChange(call) {
    query.addEventListener('change', call);
  },
  // A material that has a colour of the theme, and changes with it.
  tinted(name, material) {
    const paint = () => material.color.set(theme.is[name]);
    paint();
    theme.onChange(paint);
    return material;
  },
};
