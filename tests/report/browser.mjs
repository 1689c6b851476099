// SPDX-License-Identifier: BSD-3-Clause
// Reports in a real browser: node browser.mjs CHROMIUM LOCKSTEP SCENES FOLDER. Ends with 1 after saying what is wrong.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Chromium } from './chromium.mjs';

const [chromium, lockstep, scenes, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
copyFileSync(join(scenes, 'stewart_legs.csv'), join(folder, 'stewart_legs.csv'));

const SCENES = [
  'four_bar',
  'robot_arm',
  'stewart',
  'slider_crank',
  'spatial_chain_10_tilted',
  'gear_train',
  'mass_spring_damper',
  'bead_on_curve',
  'heavy_top',
  'peaucellier',
  'bouncing_pendulum',
  'moving_marker_ground',
];
const INSTANTS = 20,
  TOLERANCE = 1e-6;

let failures = 0,
  checks = 0;
function check(ok, words) {
  ++checks;
  if (ok) return;
  ++failures;
  console.error(`FAILED: ${words}`);
}

// The scene with the places of all bodies as its columns: what `lockstep run` records when nothing is asked for.
function makeReport(name, change = (scene) => scene) {
  const scene = change(JSON.parse(readFileSync(join(scenes, `${name}.json`), 'utf8')));
  delete scene.run.record;
  delete scene.run.draw;
  for (const { scene: part } of scene.include ?? []) copyFileSync(join(scenes, part), join(folder, part));
  return runScene(name, scene);
}

function runScene(name, scene) {
  const file = join(folder, `${name}.json`),
    csv = join(folder, `${name}.csv`),
    html = join(folder, `${name}.html`);
  writeFileSync(file, JSON.stringify(scene));
  execFileSync(lockstep, ['run', file, '--record', csv, '--report', html, '--quiet'], {
    cwd: folder,
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  return { url: pathToFileURL(html).href, csv, html };
}

// A sweep of a sample with its page.
function sweepReport(name, scene, ...words) {
  const csv = join(folder, `${name}.csv`),
    html = join(folder, `${name}.html`);
  execFileSync(
    lockstep,
    ['sweep', join(scenes, `${scene}.json`), ...words, '--record', csv, '--report', html, '--quiet'],
    { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] },
  );
  return { url: pathToFileURL(html).href, csv, html };
}

function readCsv(file) {
  const [head, ...lines] = readFileSync(file, 'utf8').trim().split('\n');
  return {
    names: head.split(',').map((title) => title.replace(/ \[.*\]$/, '')),
    rows: lines.map((line) => line.split(',').map(Number)),
  };
}

// What the software renderer of a browser without a window says of its own speed is none of the page's.
const OWN_NOTE = /GL Driver Message \(OpenGL, Performance/;

function checkQuiet(page, name) {
  const said = page.messages.filter((text) => !OWN_NOTE.test(text));
  check(said.length === 0, `${name}: the console says ${said.join('; ')}`);
  const foreign = page.requests.filter(
    (url) => !url.startsWith('file:') && !url.startsWith('data:') && !url.startsWith('blob:'),
  );
  check(foreign.length === 0, `${name}: the page asks for ${foreign.join(', ')}`);
}

// Where the page's scene graph has the bodies, at one instant.
const PLACES = (t) => `(() => {
  const r = globalThis.lockstepReport;
  r.clock.pause();
  r.clock.seek(${t});
  return Object.fromEntries(r.data.mechanism.moving.map((i) => [r.data.mechanism.bodies[i].name, [12, 13, 14].map((k) => r.world.bodies.groups[i].matrixWorld.elements[k])]));
})()`;

async function checkPlaces(page, name, csv) {
  const { names, rows } = readCsv(csv);
  let compared = 0,
    worst = 0;
  for (let i = 0; i < INSTANTS; ++i) {
    const row = rows[Math.round((i * (rows.length - 1)) / (INSTANTS - 1))];
    const places = await page.evaluate(PLACES(row[0]));
    for (const [body, x] of Object.entries(places))
      ['x', 'y', 'z'].forEach((axis, k) => {
        const expected = row[names.indexOf(`${body}.${axis}`)];
        worst = Math.max(worst, Math.abs(x[k] - expected) / Math.max(1, Math.abs(expected)));
        ++compared;
      });
  }
  check(
    compared > 0 && worst <= TOLERANCE,
    `${name}: positions differ from the CSV by ${worst} (${compared} compared)`,
  );
}

async function checkPixels(page, name) {
  const drawn = await page.evaluate(`(() => {
    const { stage } = globalThis.lockstepReport;
    stage.render();
    const copy = document.createElement('canvas');
    copy.width = stage.width; copy.height = stage.height;
    const ctx = copy.getContext('2d');
    ctx.drawImage(stage.elements.canvas, 0, 0, copy.width, copy.height);
    const { data } = ctx.getImageData(0, 0, copy.width, copy.height);
    const colors = new Set();
    for (let i = 0; i < data.length; i += 4) colors.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return colors.size;
  })()`);
  check(drawn > 20, `${name}: the picture has ${drawn} colours; a mechanism has more`);
}

const time = (page) => page.evaluate('globalThis.lockstepReport.clock.t');
const boxOf = (page, selector) =>
  page.evaluate(
    `(() => { const b = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect(); return [b.x, b.y, b.width, b.height]; })()`,
  );

// All that moves is in the picture, whatever the window; the user's own view stays.
async function checkFit(browser) {
  const { url } = makeReport('path_follower');
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  const farthest = () =>
    page.evaluate(`(() => {
      const { stage } = globalThis.lockstepReport;
      const { camera, frame } = stage.views;
      camera.updateMatrixWorld();
      return Math.max(...frame.points.map((p) => {
        const seen = p.clone().project(camera);
        return Math.max(Math.abs(seen.x), Math.abs(seen.y));
      }));
    })()`);
  for (const [width, height] of [[1200, 700], [700, 900], [1500, 500]]) {
    await page.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
    await page.settle();
    const out = await farthest();
    check(out <= 1 && out > 0.5, `in ${width} x ${height} all is seen: the farthest point is at ${out} of the half`);
  }
  await page.evaluate('globalThis.lockstepReport.stage.views.zoom(3)');
  const zoomed = await farthest();
  await page.send('Emulation.setDeviceMetricsOverride', { width: 1501, height: 501, deviceScaleFactor: 1, mobile: false });
  await page.settle();
  check((await farthest()) > 0.8 * zoomed, 'a view that was zoomed stays');
  await page.close();
}

async function checkHands(browser) {
  const { url } = makeReport('four_bar');
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  check((await time(page)) === 0, 'the page starts at the start, at rest where less motion is wished for');

  await page.key('ArrowRight');
  const step = await time(page);
  check(step > 0 && step <= 0.0100001, `the right arrow goes to the next instant, not to ${step}`);
  await page.key('ArrowLeft');
  check((await time(page)) === 0, 'the left arrow goes back');
  await page.key('End');
  check(Math.abs((await time(page)) - 0.7) < 1e-12, 'End goes to the end');
  await page.key('Home');
  check((await time(page)) === 0, 'Home goes to the start');
  await page.key(' ');
  check(await page.evaluate('globalThis.lockstepReport.clock.playing'), 'space plays');
  await new Promise((done) => setTimeout(done, 300));
  await page.key(' ');
  check(
    !(await page.evaluate('globalThis.lockstepReport.clock.playing')) && (await time(page)) > 0,
    'space pauses, and time has passed',
  );

  const [x, y, w, h] = await boxOf(page, '#slider');
  await page.click(x + w / 2, y + h / 2);
  check(Math.abs((await time(page)) - 0.35) < 0.02, `scrubbing to the middle gives ${await time(page)}`);
  const mark = await page.evaluate("getComputedStyle(document.querySelector('.time-mark')).transform");
  const [px, py, pw, ph] = await boxOf(page, '.u-over');
  check(Math.abs(Number(mark.split(',')[4]) - pw / 2) < 0.04 * pw, `the plots show the same time: ${mark} of ${pw}`);

  await page.click(px + 0.25 * pw, py + ph / 2);
  check(Math.abs((await time(page)) - 0.175) < 0.02, `a click on a plot sets the time, not ${await time(page)}`);
  await page.drag([px + 0.25 * pw, py + ph / 2], [px + 0.5 * pw, py + ph / 2]);
  const zoomed = await page.evaluate(
    'globalThis.lockstepReport.plots.plots.map(({ plot }) => [plot.scales.x.min, plot.scales.x.max])',
  );
  check(
    zoomed.every(([a, b]) => Math.abs(a - 0.175) < 0.02 && Math.abs(b - 0.35) < 0.02),
    `a drag zooms all plots: ${JSON.stringify(zoomed)}`,
  );

  // A body where its mass centre is seen.
  const [cx, cy] = await page.evaluate(`(() => {
    const { world, stage, data } = globalThis.lockstepReport;
    const i = data.mechanism.bodies.findIndex((b) => b.name === 'rocker'), p = stage.views.controls.target.clone();
    p.setFromMatrixPosition(world.bodies.groups[i].matrixWorld).project(stage.views.camera);
    const box = stage.elements.canvas.getBoundingClientRect();
    return [box.x + (0.5 + 0.5 * p.x) * box.width, box.y + (0.5 - 0.5 * p.y) * box.height];
  })()`);
  await page.click(cx, cy);
  const picked = await page.evaluate(
    "[document.querySelector('#body h3')?.textContent, document.querySelector('#body').textContent]",
  );
  check(picked[0] === 'rocker', `picking the rocker shows ${picked[0]}`);
  for (const word of ['0.9 kg', 'revolute with coupler', 'rocker.x'])
    check(picked[1].includes(word), `the panel of the rocker says ${word}`);
  await page.key('Escape');
  check((await page.evaluate("document.querySelector('#body h3')")) === null, 'Escape lets the body go');

  const before = await page.evaluate('globalThis.lockstepReport.stage.views.camera.position.toArray()');
  const [sx, sy, sw] = await boxOf(page, '#canvas');
  await page.drag([sx + sw / 2, sy + 30], [sx + sw / 2 + 120, sy + 60]);
  const after = await page.evaluate('globalThis.lockstepReport.stage.views.camera.position.toArray()');
  check(
    before.some((c, k) => Math.abs(c - after[k]) > 1e-3),
    'dragging turns the view',
  );
  await page.key('o');
  check(
    !(await page.evaluate('globalThis.lockstepReport.stage.views.isOrthographic')),
    'O changes between the two projections',
  );
  for (const key of ['1', '2', '3', '4', 'f', 'n', 'n', 'l']) await page.key(key);

  // The view by keys: from the front an eighth of a right angle about "up", then the same upwards; nearer; to the side.
  const VIEW =
    '(() => { const { views } = globalThis.lockstepReport.stage; return { arm: views.camera.position.clone().sub(views.controls.target).toArray(), target: views.controls.target.toArray(), scale: views.metresPerPixel(100) }; })()';
  const angle = (a, b) =>
    Math.acos(a.reduce((sum, c, k) => sum + c * b[k], 0) / (Math.hypot(...a) * Math.hypot(...b)));
  await page.key('2');
  const front = await page.evaluate(VIEW);
  await page.key('d');
  const turned = await page.evaluate(VIEW);
  check(Math.abs(angle(front.arm, turned.arm) - Math.PI / 16) < 1e-6, `D turns by ${angle(front.arm, turned.arm)}`);
  await page.key('w');
  const raised = await page.evaluate(VIEW);
  check(
    Math.abs(angle(turned.arm, raised.arm) - Math.PI / 16) < 1e-6 && raised.arm[1] > turned.arm[1],
    `W raises the view by ${angle(turned.arm, raised.arm)}`,
  );
  await page.key('s');
  await page.key('a');
  check(angle(front.arm, (await page.evaluate(VIEW)).arm) < 1e-6, 'S and A lead back');
  await page.key('+');
  const near = await page.evaluate(VIEW);
  check(Math.abs(front.scale / near.scale - 1.2) < 1e-6, `plus makes things ${front.scale / near.scale} times larger`);
  await page.key('-');
  await page.key('D');
  const aside = await page.evaluate(VIEW);
  check(
    Math.abs(aside.target[0] - front.target[0] - 0.1 * 100 * front.scale) < 1e-6,
    `shift and D move the view by ${aside.target[0] - front.target[0]}`,
  );

  // Every control is reached and pressed by keys alone.
  const names = await page.evaluate(
    "[...document.querySelectorAll('button, select, input, summary')].filter((e) => e.offsetParent !== null && !e.disabled && e.tabIndex >= 0).map((e) => [e.tagName, (e.getAttribute('aria-label') || e.textContent).trim()])",
  );
  check(names.length > 15 && names.every(([, name]) => name !== ''), `a control has no name: ${JSON.stringify(names)}`);
  await page.evaluate("document.querySelector('#run-tab').focus()");
  await page.key('ArrowRight');
  check(!(await page.evaluate("document.querySelector('#scene-panel').hidden")), 'arrow keys go from tab to tab');
  check(
    (await page.evaluate("document.querySelector('#scene').textContent")).includes('"crank"'),
    'the scene is shown as it was written',
  );
  const made = await page.evaluate("document.querySelector('#run').textContent");
  check(/lockstep[\d.]+on.*processor/.test(made), `the page names the machine: ${made.slice(-200)}`);
  checkQuiet(page, 'four_bar by hand');
  await page.close();
}

// Names that try to be more than names.
async function checkHostile(browser) {
  const evil = `</script><img src=x onerror="globalThis.struck = 1"><b>'"&lt;\\`;
  const mean = `</script><img src=x onerror=struck=1><b>&lt;\\`; // scenes take no quotes and points in names
  const long = `${mean}${'w'.repeat(10000)}`,
    title = `${evil}${'w'.repeat(10000)}`;
  const { url, html } = runScene('hostile', {
    lockstep: 1,
    title,
    description: evil,
    gravity: [0, 0, -9.81],
    bodies: [
      { name: long, mass: 1, inertia: [1, 1, 1], position: [1, 0, 0] },
      { name: `${mean}2`, particle: 1, position: [0, 1, 0] },
    ],
    markers: [{ name: `${mean} tip`, body: long, at: [0, 0, 1] }],
    links: [{ name: `${mean} joint`, type: 'spherical', p: long, s: 'ground', at: [0, 0, 0] }],
    run: { until: 0.2, output: 0.02 },
  });
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  await page.evaluate("for (const id of ['bodies-tab', 'run-tab', 'scene-tab']) document.getElementById(id).click()");
  await page.evaluate('globalThis.lockstepReport.select(1)');
  await page.settle();
  const seen = await page.evaluate(
    "({ struck: globalThis.struck, images: document.querySelectorAll('img, b:not(#time)').length, title: document.title, heading: document.querySelector('h1').textContent, body: document.querySelector('#body h3').textContent, label: document.querySelector('.label').textContent })",
  );
  check(
    seen.struck === undefined && seen.images === 0,
    `a name became a part of the page: ${JSON.stringify(seen).slice(0, 200)}`,
  );
  check(seen.heading === title && seen.body === long, 'long names are whole where they are asked for');
  check(seen.title.startsWith(evil.slice(0, 9)), `the window is called ${seen.title.slice(0, 40)}`);
  check(seen.label.length <= 40, 'names in the picture are cut');
  const wide = await page.evaluate('document.documentElement.scrollWidth - innerWidth');
  check(wide <= 0, `long names make the page ${wide} pixels too wide`);
  check(readFileSync(html, 'utf8').split('<script').length === 4, 'the file has its three scripts');
  checkQuiet(page, 'hostile names');
  await page.close();
}

// Text against its ground: 4.5 to 1, by the formula of WCAG 2.
const CONTRAST = `(() => {
  const ctx = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
  const rgb = (color) => { ctx.clearRect(0, 0, 1, 1); ctx.fillStyle = color; ctx.fillRect(0, 0, 1, 1); return ctx.getImageData(0, 0, 1, 1).data; };
  const light = (c) => [...c].slice(0, 3).map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4).reduce((s, v, k) => s + v * [0.2126, 0.7152, 0.0722][k], 0);
  const ground = (e) => { for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor, p = rgb(c); if (p[3] > 200) return p; } return [255, 255, 255]; };
  const poor = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const e = walk.currentNode.parentElement;
    if (!walk.currentNode.textContent.trim() || e.closest('script, style, :disabled, option')) continue;
    if (!e.checkVisibility()) continue;
    const [a, b] = [light(rgb(getComputedStyle(e).color)), light(ground(e))].sort((p, q) => q - p);
    if ((a + 0.05) / (b + 0.05) < 4.5) poor.push(e.tagName + '.' + e.className + ' "' + walk.currentNode.textContent.trim().slice(0, 20) + '" ' + ((a + 0.05) / (b + 0.05)).toFixed(2));
  }
  return [...new Set(poor)];
})()`;

async function checkContrast(browser) {
  const { url } = makeReport('mass_spring_damper');
  for (const dark of [false, true]) {
    const page = await browser.page({ dark });
    await page.open(url);
    await page.settle();
    for (const tab of ['plots-tab', 'bodies-tab', 'run-tab', 'scene-tab']) {
      await page.evaluate(`document.getElementById('${tab}').click(), globalThis.lockstepReport.select(1)`);
      await page.settle();
      const poor = await page.evaluate(CONTRAST);
      check(poor.length === 0, `${dark ? 'dark' : 'light'}, ${tab}: too little contrast in ${poor.join('; ')}`);
    }
    checkQuiet(page, dark ? 'dark' : 'light');
    await page.close();
  }
}

// A sweep of two variables: a point for each run, a map by colour, a row of cells for the point under the mouse.
async function checkSweep(browser) {
  const { url, csv } = sweepReport(
    'sweep',
    'rod_pendulum',
    ...['--vary', 'bodies.rod.rod.mass=1:3:3', '--vary', 'gravity.1=-9.81,-1.62,-3.7', '--until', '0.2'],
  );
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  const [, ...rows] = readFileSync(csv, 'utf8').trim().split('\n');
  const points = await page.evaluate(
    '(() => { const p = globalThis.lockstepReport.points; return p.scatter.seen.map((i) => [p.table.columns[p.x].numbers[i], p.table.columns[p.y].numbers[i]]); })()',
  );
  check(
    points.length === 9 && rows.length === 9,
    `a sweep of nine runs shows ${points.length} points of ${rows.length} rows`,
  );
  rows.forEach((row, i) => {
    const cells = row.split(',').map(Number);
    check(cells.includes(points[i][0]) && cells.includes(points[i][1]), `point ${points[i]} is none of row ${row}`);
  });
  const [x, y] = await page.evaluate(
    '(() => { const p = globalThis.lockstepReport.points, b = p.scatter.plot.over.getBoundingClientRect(), [x, y] = p.scatter.placeOf(4); return [b.x + x, b.y + y]; })()',
  );
  await page.mouse('mouseMoved', x, y);
  await page.settle();
  const shown = await page.evaluate("document.querySelector('#points-row').textContent");
  check(
    shown.includes('bodies.rod.rod.mass') && shown.includes('gravity.1'),
    `the run under the mouse is shown, not "${shown}"`,
  );
  await page.evaluate(
    "(() => { for (const [id, value] of [['points-y', '2'], ['points-color', '4']]) { const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event('change')); } })()",
  );
  await page.settle();
  check(
    !(await page.evaluate("document.querySelector('#points-scale').hidden")),
    'a column of numbers gives the colour, with its scale',
  );
  const poor = await page.evaluate(CONTRAST);
  check(poor.length === 0, `the page of a sweep has too little contrast in ${poor.join('; ')}`);
  checkQuiet(page, 'sweep');
  await page.close();
}

// Corners of the triangles of a body's meshes, in the world.
const MESHES = `(() => {
  const { world } = globalThis.lockstepReport;
  const found = [];
  world.bodies.groups[1].traverse((o) => {
    if (!o.isMesh || !o.geometry.index || o.geometry.type !== 'BufferGeometry') return;
    const at = o.geometry.getAttribute('position'), e = o.matrixWorld.elements, points = [];
    for (const i of o.geometry.index.array) {
      const p = [at.getX(i), at.getY(i), at.getZ(i)];
      points.push([0, 1, 2].map((k) => e[k] * p[0] + e[4 + k] * p[1] + e[8 + k] * p[2] + e[12 + k]));
    }
    found.push({ points, color: '#' + o.material.color.getHexString(), opacity: o.material.opacity });
  });
  return found;
})()`;

// Six times the volume that triangles enclose.
function sixVolumes(points) {
  let sum = 0;
  for (let i = 0; i < points.length; i += 3) {
    const [a, b, c] = points.slice(i, i + 3);
    sum +=
      a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum;
}

// Meshes and further shapes of bodies: a unit cube, scaled, placed and seen.
async function checkVisual(browser) {
  const cube = ['v 0 0 0', 'v 0 0 1', 'v 0 1 0', 'v 0 1 1', 'v 1 0 0', 'v 1 0 1', 'v 1 1 0', 'v 1 1 1'];
  const faces = ['f 1 2 4 3', 'f 5 7 8 6', 'f 1 5 6 2', 'f 3 4 8 7', 'f 1 3 7 5', 'f 2 6 8 4'];
  writeFileSync(join(folder, 'cube.obj'), [...cube, ...faces, ''].join('\n'));
  const { url } = runScene('visual', {
    lockstep: 1,
    title: 'a cube as a mesh',
    gravity: [0, 0, 0],
    bodies: [
      {
        name: 'carrier',
        sphere: { mass: 1, radius: 0.3 },
        position: [1, 2, 3],
        omega_body: [0, 0, 1],
        visual: {
          color: '#cc5500',
          opacity: 0.5,
          own_shape: false,
          shapes: [
            { mesh: 'cube.obj', scale: 0.5, at: [0.1, 0, 0], orientation: { axis: 'x', angle: '90 deg' } },
            { cylinder: { radius: 0.1, length: 1 } },
          ],
        },
      },
    ],
    run: { until: 1, output: 0.1 },
  });
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  const found = await page.evaluate(MESHES);
  check(found.length === 1, `a body with one mesh has ${found.length}`);
  const { points, color, opacity } = found[0];
  check(points.length === 36, `a cube of six quadrangles has ${points.length / 3} triangles`);
  // Volume by the theorem of Gauss; the cube reaches from (1.1, 2 - 0.5, 3) on.
  check(Math.abs(sixVolumes(points) / 6 - 0.125) < 1e-5, `the mesh has the volume ${sixVolumes(points) / 6}`);
  const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k]))),
    expected = [1.1, 1.5, 3];
  check(
    low.every((v, k) => Math.abs(v - expected[k]) < 1e-5),
    `the mesh begins at ${low}`,
  );
  check(color === '#cc5500' && opacity === 0.5, `the mesh has the colour ${color} and the opacity ${opacity}`);
  const spheres = await page.evaluate(
    "(() => { let n = 0; globalThis.lockstepReport.world.bodies.groups[1].traverse((o) => { if (o.geometry?.type === 'SphereGeometry' && o.geometry.parameters.radius > 0.2 && o.material.color.getHexString() === 'cc5500') ++n; }); return n; })()",
  );
  check(spheres === 0, 'the own shape of the body is not drawn where the scene says so');
  await checkPixels(page, 'a mesh');
  checkQuiet(page, 'a mesh');
  await page.close();
}

// Signs at links: which are seen at a time.
const SIGNS = (t) => `(() => {
  const r = globalThis.lockstepReport;
  r.clock.pause();
  r.clock.seek(${t});
  const seen = (sprites) => sprites.some((s) => s.visible);
  return Object.fromEntries(r.data.mechanism.links.map((link, i) => [link.name, { warning: seen(r.world.badges.links[i].warnings), cross: seen(r.world.badges.links[i].crosses) }]));
})()`;

// A joint that is cut at 0.1 s, of a loop whose rows in space are more than it needs.
async function checkMarks(browser) {
  const scene = JSON.parse(readFileSync(join(scenes, 'four_bar.json'), 'utf8'));
  delete scene.run.record;
  delete scene.run.draw;
  scene.planar = 'off';
  scene.run.until = 0.2;
  const cut = scene.joints.at(-1).name;
  scene.events = [{ name: 'cut', at: 0.1, deactivate: [cut] }];
  const { url } = runScene('marks', scene);
  const said = JSON.parse(
    execFileSync(lockstep, ['check', join(folder, 'marks.json'), '--json'], { cwd: folder, encoding: 'utf8' }),
  );
  const redundant = new Set(said.rows_not_unique.map((row) => row.split('.')[0]));
  check(redundant.size > 1, 'a four-bar in space has reactions that are not unique');
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  const before = await page.evaluate(SIGNS(0.09)),
    after = await page.evaluate(SIGNS(0.11));
  for (const [name, signs] of Object.entries(before)) {
    check(signs.warning === redundant.has(name), `link ${name}: the sign of redundant rows is ${signs.warning}`);
    check(!signs.cross, `link ${name} is not broken before it is cut`);
  }
  for (const [name, signs] of Object.entries(after))
    check(signs.cross === (name === cut), `link ${name}: the cross after the cut is ${signs.cross}`);
  const words = await page.evaluate("document.querySelector('#run .remarks').textContent");
  check(words.includes(`${cut}deactivated at 0.1 s, by event 'cut'`), `the run tells of the cut: ${words}`);
  for (const name of redundant) check(words.includes(`${name}reaction not unique`), `the run tells of ${name}: ${words}`);
  await page.evaluate("globalThis.lockstepReport.select(globalThis.lockstepReport.data.mechanism.bodies.findIndex((b) => b.name === 'rocker'))");
  const panel = await page.evaluate("document.querySelector('#body').textContent");
  check(panel.includes('deactivated at 0.1 s') && panel.includes('not unique'), `the body tells of both: ${panel}`);
  checkQuiet(page, 'marks');
  await page.close();
}

// Driven, the four-bar's first column ends at one angle in all runs: what varies is shown.
async function checkVarying(browser) {
  const { url } = sweepReport('driven', 'four_bar', '--vary', 'crank=80 mm,90 mm,100 mm', '--until', '0.1');
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  const [title, numbers] = await page.evaluate(
    '(() => { const p = globalThis.lockstepReport.points, c = p.table.columns[p.y]; return [c.title, [...c.numbers]]; })()',
  );
  check(/ (min|max)/.test(title) && !title.startsWith('theta '), `the first picture of a sweep shows ${title}`);
  check(Math.max(...numbers) - Math.min(...numbers) > 1e-6, `${title} varies: ${numbers}`);
  await page.close();
}

// A run of a sweep, opened from its point: its columns and its motion, against its own CSV.
async function checkHistories(browser) {
  const kept = join(folder, 'kept');
  const { url, csv } = sweepReport(
    'kept',
    'rod_pendulum',
    ...['--vary', 'length=0.5:1.5:3', '--until', '0.5', '--histories', kept],
  );
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  await page.evaluate(
    "(() => { const e = document.getElementById('points-y'); e.value = '3'; e.dispatchEvent(new Event('change')); })()",
  );
  await page.settle();
  const [x, y] = await page.evaluate(
    '(() => { const p = globalThis.lockstepReport.points, b = p.scatter.plot.over.getBoundingClientRect(), [x, y] = p.scatter.placeOf(1); return [b.x + x, b.y + y]; })()',
  );
  const loaded = new Promise((done) => {
    page.loaded = done;
  });
  await page.click(x, y).catch(() => {}); // the page is left meanwhile
  await loaded;
  await page.settle();
  const heading = await page.evaluate("document.querySelector('h1').textContent");
  check(heading.endsWith('run 2'), `a click on the second point opens ${heading}`);
  const { names, rows } = readCsv(join(kept, '2.csv'));
  const columns = await page.evaluate(
    'globalThis.lockstepReport.data.table.columns.map((c) => [c.name, Array.from(c.values)])',
  );
  check(columns.length === names.length, `run 2 has ${columns.length} columns of ${names.length}`);
  let worst = 0;
  for (const [k, [name, values]] of columns.entries()) {
    check(name === names[k] && values.length === rows.length, `column ${name} of run 2 has ${values.length} rows`);
    rows.forEach((row, i) => {
      worst = Math.max(worst, Math.abs(row[k] - values[i]) / Math.max(1, Math.abs(row[k])));
    });
  }
  check(worst < TOLERANCE, `the columns of run 2 differ from its CSV by ${worst}`);
  // The rod of this run is as long as its variable says: its middle keeps half of that from the hinge at the origin.
  const length = Number(readFileSync(csv, 'utf8').trim().split('\n')[2].split(',')[1]);
  for (const t of [0, 0.25, 0.5]) {
    const places = await page.evaluate(PLACES(t));
    const distance = Math.hypot(...places.rod);
    check(Math.abs(distance - length / 2) < 1e-5, `the rod of run 2 swings at ${distance}, half of ${length}`);
  }
  check((await page.evaluate("document.querySelectorAll('.uplot').length")) > 0, 'the curves of the run are drawn');
  const again = new Promise((done) => {
    page.loaded = done;
  });
  await page.evaluate("document.querySelector('#back_to_runs').click()").catch(() => {});
  await again;
  await page.settle();
  check(
    (await page.evaluate("document.querySelector('#points-y').value")) === '3',
    'coming back from a run, the axes are those that were chosen',
  );
  const links = await page.evaluate("[...document.querySelectorAll('.points-table a')].map((a) => a.getAttribute('href'))");
  check(links.join() === '#run=1,#run=2,#run=3', `the table leads to the runs: ${links}`);
  const poor = await page.evaluate(CONTRAST);
  check(poor.length === 0, `the page of histories has too little contrast in ${poor.join('; ')}`);
  checkQuiet(page, 'histories');
  await page.close();
}

// The page of a search: the given run next to the found one, against the CSV of the given scene.
async function checkBefore(browser) {
  const scene = join(scenes, 'slider_crank.json'),
    csv = join(folder, 'given.csv'),
    html = join(folder, 'found.html'),
    options = { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] };
  execFileSync(lockstep, ['run', scene, '--record', csv, '--no-picture', '--quiet'], options);
  const search = ['--vary', 'crank=100 mm:200 mm', '--reach', 'max(drive_torque) = 3 N m'];
  execFileSync(lockstep, ['find', scene, ...search, '--report', html], options);
  const page = await browser.page();
  await page.open(pathToFileURL(html).href);
  await page.settle();
  const { names, rows } = readCsv(csv);
  const columns = await page.evaluate(
    'globalThis.lockstepReport.data.table.columns.map((c) => [c.name, Array.from(c.values)])',
  );
  check(columns.length === 2 * names.length - 1, `a page of two runs has ${columns.length} columns of ${names.length} each`);
  let worst = 0;
  for (const [k, [name, values]] of columns.slice(names.length).entries()) {
    check(name === `${names[k + 1]} before`, `column ${name} is that of ${names[k + 1]} before`);
    rows.forEach((row, i) => {
      worst = Math.max(worst, Math.abs(row[k + 1] - values[i]) / Math.max(1, Math.abs(row[k + 1])));
    });
  }
  check(worst < TOLERANCE, `the columns before differ from the CSV of the given scene by ${worst}`);
  const cells = await page.evaluate(
    "[...document.querySelectorAll('#plots-panel > table tr')].map((row) => [...row.cells].map((c) => c.textContent))",
  );
  const of = (title) => cells.find(([name]) => name === title)?.slice(1).map(Number) ?? [];
  const [given, found] = of('crank [mm]'),
    torques = of('max(drive_torque) = 3 N m [N m]');
  check(given === 150 && found > 100 && found < 150, `the table has the cranks ${given} and ${found}`);
  const peak = Math.max(...rows.map((row) => row[names.indexOf('drive_torque')]));
  check(Math.abs(torques[0] - peak) < 0.01 * peak && torques[1] === 3, `the table has the torques ${torques}, not ${peak}`);
  // The middle of a crank keeps half of its length from the hinge at the origin.
  for (const t of [0, 0.3]) {
    await page.evaluate(PLACES(t));
    const lengths = await page.evaluate(
      "globalThis.lockstepReport.world.root.children.filter((o) => o.name === 'crank').map((o) => 2000 * o.position.length())",
    );
    const right = lengths.length === 2 && [found, given].every((length, i) => Math.abs(lengths[i] - length) < 0.01);
    check(right, `at ${t} s the cranks have the lengths ${lengths}`);
  }
  checkQuiet(page, 'before');
  await page.close();
}

// Modes in the page against those that the program prints: places of bodies at phases of a mode, and its frequency.
async function checkModes(browser) {
  const masses = [1, 2, 3].map((i) => ({ name: `m${i}`, particle: i, position: [i, 0, 0] }));
  const file = join(folder, 'masses.json'),
    html = join(folder, 'modes.html');
  writeFileSync(
    file,
    JSON.stringify({
      lockstep: 1,
      title: 'three masses on springs and one damper',
      gravity: [0, 0, 0],
      bodies: masses,
      links: masses.map(({ name, position }, i) => ({
        ...{ name: `guide_${i + 1}`, type: 'lock', mask: 'y z', p: name, s: 'ground', at: position },
      })),
      forces: [
        { name: 'k1', type: 'spring_damper', p: 'm1', s: 'ground', at_p: [1, 0, 0], at_s: [0, 0, 0], stiffness: 100, free_length: 1 },
        { name: 'k2', type: 'spring_damper', p: 'm2', s: 'm1', at_p: [2, 0, 0], at_s: [1, 0, 0], stiffness: 80, free_length: 1, damping: 3 },
        { name: 'k3', type: 'spring_damper', p: 'm3', s: 'm2', at_p: [3, 0, 0], at_s: [2, 0, 0], stiffness: 60, free_length: 1 },
      ],
      run: { until: 1, output: 0.1 },
    }),
  );
  const said = JSON.parse(
    execFileSync(lockstep, ['modes', file, '--report', html, '--json'], { cwd: folder, encoding: 'utf8' }),
  );
  const page = await browser.page();
  await page.open(pathToFileURL(html).href);
  await page.settle();
  check(said.modes.length === 3, `three masses on a line have ${said.modes.length} modes`);
  const complex = said.modes.some((m) => m.shape.some((s) => Math.abs(s.move[0][1]) > 1e-3));
  check(complex, 'one damper makes the modes complex');
  for (const [k, mode] of said.modes.entries()) {
    await page.evaluate(`(() => { const e = document.getElementById('mode'); e.value = '${k}'; e.dispatchEvent(new Event('change')); })()`);
    const name = await page.evaluate("document.querySelector('#mode').selectedOptions[0].textContent");
    check(Math.abs(Number(/: (.*) Hz/.exec(name)[1]) - mode.frequency) < 1e-3, `mode ${k + 1} is called ${name}`);
    for (const eighth of [0, 1, 2, 3, 5]) {
      const places = await page.evaluate(PLACES(eighth / 4));
      const a = await page.evaluate('globalThis.lockstepReport.amplitude');
      const phase = (eighth * Math.PI) / 4;
      for (const { body, move } of mode.shape) {
        const x = Number(body.slice(1)) + a * (move[0][0] * Math.cos(phase) - move[0][1] * Math.sin(phase));
        check(
          Math.abs(places[body][0] - x) < 1e-5,
          `mode ${k + 1}, ${body} at ${eighth}/8 of a swing: ${places[body][0]}, not ${x}`,
        );
      }
    }
  }
  const before = (await page.evaluate(PLACES(0))).m3[0];
  await page.evaluate(
    "(() => { const e = document.getElementById('amplitude'); e.value = '-1.3'; e.dispatchEvent(new Event('input')); })()",
  );
  const after = (await page.evaluate(PLACES(0))).m3[0];
  const ratio = (after - 3) / (before - 3);
  check(Math.abs(ratio - 10 ** -1.3 / 0.2) < 1e-3, `the slider changes the amplitude by ${ratio}`);
  check(
    (await page.evaluate("document.querySelectorAll('.modes-table tbody tr').length")) === 3,
    'the table has a row a mode',
  );
  await page.evaluate("document.querySelectorAll('.modes-table button')[1].focus()");
  await page.key('Enter');
  check((await page.evaluate("document.querySelector('#mode').value")) === '1', 'a key in the table chooses a mode');
  const poor = await page.evaluate(CONTRAST);
  check(poor.length === 0, `the page of modes has too little contrast in ${poor.join('; ')}`);
  checkQuiet(page, 'modes');
  await page.close();
}

// Between coarse rows curves go by the rates: a point on a circle, sampled once a radian, stays on it.
async function checkCurves(browser) {
  const { url } = runScene('circle', {
    lockstep: 1,
    title: 'a crank that turns one radian a row',
    bodies: [{ name: 'crank', rod: { mass: 1, from: [0, 0, 0], to: [2, 0, 0] } }],
    links: [
      {
        ...{ name: 'A', type: 'revolute', p: 'crank', s: 'ground', at: [0, 0, 0] },
        drive: { axis: 'rz', law: { type: 'ramp', slope: 10 } },
      },
    ],
    run: { until: 1, output: 0.1, record: ['crank.x', 'crank.y'] },
  });
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  await page.evaluate("document.querySelector('#against').parentElement.open = true");
  await page.settle();
  await page.settle();
  for (const t of [0.05, 0.13, 0.47, 0.86]) {
    const [x, y] = await page.evaluate(`(() => {
      const { clock, against } = globalThis.lockstepReport;
      clock.pause();
      clock.seek(${t});
      const [, x, y] = /translate\\((.*)px, (.*)px\\)/.exec(against.dot.style.transform).map(Number);
      return [against.plot.posToVal(x, 'x'), against.plot.posToVal(y, 'y')];
    })()`);
    check(
      Math.hypot(x - Math.cos(10 * t), y - Math.sin(10 * t)) < 0.004,
      `at ${t} s the dot is at ${[x, y]}, not at ${[Math.cos(10 * t), Math.sin(10 * t)]}`,
    );
  }
  // The curve itself has its points where the circle is: a dark pixel within a line's width of it, between two rows.
  const drawn = await page.evaluate(`(() => {
    const { plot } = globalThis.lockstepReport.against, hits = [];
    const copy = document.createElement('canvas');
    copy.width = plot.ctx.canvas.width; copy.height = plot.ctx.canvas.height;
    const ctx = copy.getContext('2d', { willReadFrequently: true });
    ctx.drawImage(plot.ctx.canvas, 0, 0);
    for (const t of [0.05, 0.15, 0.25, 0.35, 0.45]) {
      const x = Math.round(plot.valToPos(Math.cos(10 * t), 'x', true)), y = Math.round(plot.valToPos(Math.sin(10 * t), 'y', true));
      const { data } = ctx.getImageData(x - 2, y - 2, 5, 5);
      let found = false;
      for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 128 && data[i + 2] > 100 && data[i] < 60) found = true;
      hits.push(found);
    }
    return hits;
  })()`);
  check(drawn.every((hit) => hit), `between the rows the curve is drawn on the circle: ${drawn}`);
  // Thinned histories may have no frame at a row: their curves are no polygons all the same.
  const cubics = await page.evaluate(`(() => {
    const { plots, data } = globalThis.lockstepReport, own = Path2D.prototype.bezierCurveTo;
    const { plot, group } = plots.plots[0];
    const count = () => {
      let n = 0;
      Path2D.prototype.bezierCurveTo = function (...points) { ++n; return own.apply(this, points); };
      plots.pathsOf(group, 0)(plot, 1, 0, data.table.columns[0].values.length - 1);
      Path2D.prototype.bezierCurveTo = own;
      return n;
    };
    const whole = count();
    data.frames.times = data.frames.times.map((t) => t + 1e-3);
    return [whole, count()];
  })()`);
  check(
    cubics.every((n) => n === 10),
    `ten intervals are cubics, with frames at the rows and without: ${cubics}`,
  );
  checkQuiet(page, 'curves');
  await page.close();
}

// Rows at the zeros of 0.3 sin(20 pi t): the column is flat, and the torque swings to (1/3 + 1e-4) (20 pi)^2 0.3 +
// 0.5 9.81 cos 0.3, where a ring is.
async function checkExtremes(browser) {
  const peak = (1 / 3 + 1e-4) * (20 * Math.PI) ** 2 * 0.3 + 0.5 * 9.81 * Math.cos(0.3);
  const { url } = runScene('peak', {
    lockstep: 1,
    gravity: [0, -9.81, 0],
    bodies: [{ name: 'arm', rod: { mass: 1, from: [0, 0, 0], to: [1, 0, 0] } }],
    joints: [
      { name: 'A', type: 'revolute', p: 'arm', s: 'ground', at: [0, 0, 0],
        drive: { axis: 'rz', law: { type: 'formula', y: '=0.3*sin(2*pi*10*t)' } } },
    ],
    run: { until: 1, output: 0.05, record: [{ M: 'A.drive.torque_on_p_link_z' }] },
  });
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  const seen = await page.evaluate(`(() => {
    const [head, row] = document.querySelector('#extremes table').rows, { plot } = globalThis.lockstepReport.plots.plots[0];
    row.querySelectorAll('button')[1].click();
    const { t } = globalThis.lockstepReport.clock;
    return { cells: [...row.cells].map((c) => c.textContent), t, top: plot.scales.y.max, curve: Math.max(...plot.data[1]) };
  })()`);
  check(Math.abs(Number(seen.cells[3]) - peak) < 1e-4 * 2 * peak, `the greatest value is ${peak}, not ${seen.cells}`);
  check(Math.abs(Math.sin(20 * Math.PI * seen.t)) > 0.999, `a click on a time goes to an end of the swing, not to ${seen.t}`);
  check(seen.top > peak && seen.curve < 5, `the axis ends at ${seen.top}, the curve at ${seen.curve}`);
  checkQuiet(page, 'extremes');
  await page.close();
}

// A long run: at most 20 MB, the picture at its frames where the run was, trails without corners, curves to all extremes.
async function checkLong(browser) {
  const { url, html } = runScene('long', {
    lockstep: 1,
    bodies: [{ name: 'wheel', cylinder: { mass: 1, radius: 1, length: 0.1 } }],
    joints: [
      { name: 'A', type: 'revolute', p: 'wheel', s: 'ground', at: [0, 0, 0], start: { velocity: { rz: 6.283185307179586 } } },
    ],
    markers: [{ name: 'rim', body: 'wheel', at: [1, 0, 0] }],
    run: { until: 2000, output: 0.005, step: 0.05, record: ['rim.x', 'rim.y', 'rim.vx', 'rim.vy', 'rim.ax', 'rim.ay'] },
  });
  check(statSync(html).size <= 20e6, `the page of a long run has ${statSync(html).size} bytes`);
  const page = await browser.page();
  await page.open(url);
  await page.settle();
  const seen = await page.evaluate(`(() => {
    const { data, world, clock, plots } = globalThis.lockstepReport;
    clock.pause();
    const off = [], radii = [];
    for (const part of [0, 0.3, 0.77, 1]) {
      const t = data.frames.times[Math.round(part * (data.frames.n - 1))];
      clock.seek(t);
      const { past } = world.trails.lines.values().next().value;
      const { array } = past.geometry.getAttribute('position');
      const last = 3 * (past.geometry.drawRange.count - 1);
      off.push(Math.hypot(array[last] - Math.cos(2 * Math.PI * t), array[last + 1] - Math.sin(2 * Math.PI * t)));
      for (let i = 3; i < array.length; i += 3) radii.push(Math.hypot((array[i] + array[i - 3]) / 2, (array[i + 1] + array[i - 2]) / 2));
    }
    const { columns, rows, stride } = data.table;
    return { off: Math.max(...off), inner: Math.min(...radii), rows, stride, frames: data.frames.stride,
      top: Math.max(...columns[3].curve), said: document.querySelector('#run').textContent };
  })()`);
  check(seen.off < 1e-3, `a trail ends where the point is; it is ${seen.off} m away`);
  check(seen.inner > 0.95, `trails are circles; chords come to within ${seen.inner} of the centre`);
  check(seen.rows === 400001 && seen.stride > 1 && seen.frames > 1, `rows ${seen.rows}, 1 in ${seen.stride}, ${seen.frames}`);
  check(Math.abs(seen.top - 2 * Math.PI) < 1e-3, `the greatest speed is ${seen.top}`);
  check(seen.said.includes(`1 in ${seen.stride} is in this file`), 'the page reports what is left out');
  checkQuiet(page, 'long');
  await page.close();
}

const browser = new Chromium(chromium);
try {
  for (const name of SCENES) {
    const { url, csv } = makeReport(name);
    const page = await browser.page();
    await page.open(url);
    await page.settle();
    await checkPlaces(page, name, csv);
    await checkPixels(page, name);
    checkQuiet(page, name);
    await page.close();
  }
  await checkFit(browser);
  await checkHands(browser);
  await checkHostile(browser);
  await checkContrast(browser);
  await checkSweep(browser);
  await checkVarying(browser);
  await checkCurves(browser);
  await checkVisual(browser);
  await checkMarks(browser);
  await checkHistories(browser);
  await checkBefore(browser);
  await checkModes(browser);
  await checkExtremes(browser);
  await checkLong(browser);
} finally {
  await browser.close();
}
console.log(`${checks} checks in the browser, ${failures} failed`);
process.exit(failures > 0 ? 1 : 0);
