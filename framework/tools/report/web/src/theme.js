// SPDX-License-Identifier: BSD-3-Clause
// Theme: the colours of the PNG charts, and what light and dark need beside them.

// Okabe and Ito, as in the charts; the last one is ink.
const PALETTE = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];
const PALETTE_DARK = ['#3a9bdc', '#f0793a', '#2bbd94', '#dd94bd', '#f0b53c', '#7cc6f2'];

const LIGHT = {
  dark: false,
  background: '#f7f8fa',
  ink: '#1c2530',
  soft: '#5a6573',
  line: '#c9d0d8',
  grid: '#b9c3cf',
  joint: '#3c4754',
  pin: '#ffffff',
  ground: '#8a95a1',
  drive: '#d55e00',
  force: '#c2410c',
  moment: '#7b3fa0',
  reaction: '#00684c',
  cursor: '#1c2530',
  spring: '#6b5a1e',
  plotGrid: '#e3e7ec',
};
const DARK = {
  dark: true,
  background: '#12161c',
  ink: '#e8edf3',
  soft: '#a3afbd',
  line: '#38424f',
  grid: '#3d4957',
  joint: '#c3ccd6',
  pin: '#12161c',
  ground: '#7d8894',
  drive: '#f0793a',
  force: '#ff8f5a',
  moment: '#c79be6',
  reaction: '#3ed0a3',
  cursor: '#e8edf3',
  spring: '#d9c173',
  plotGrid: '#262e38',
};

const query = matchMedia('(prefers-color-scheme: dark)');

export const theme = {
  get is() {
    return query.matches ? DARK : LIGHT;
  },
  // The n-th colour; after six the ink.
  color(n) {
    const colors = query.matches ? PALETTE_DARK : PALETTE;
    return n % 7 === 6 ? this.is.ink : colors[n % 7];
  },
  // Colours of bodies: without ink, which is for joints.
  bodyColor(n) {
    return (query.matches ? PALETTE_DARK : PALETTE)[n % 6];
  },
  onChange(call) {
    query.addEventListener('change', call);
  },
};
