// Reports in a real browser: node browser.mjs CHROMIUM LOCKSTEP SCENES FOLDER. Ends with 1 after saying what is wrong.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
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
  const csv = join(folder, 'sweep.csv'),
    html = join(folder, 'sweep.html');
  execFileSync(
    lockstep,
    [
      'sweep',
      join(scenes, 'rod_pendulum.json'),
      '--vary',
      'bodies.rod.rod.mass=1:3:3',
      '--vary',
      'gravity.1=-9.81,-1.62,-3.7',
      '--until',
      '0.2',
      '--record',
      csv,
      '--report',
      html,
      '--quiet',
    ],
    { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] },
  );
  const page = await browser.page();
  await page.open(pathToFileURL(html).href);
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
  await checkHands(browser);
  await checkHostile(browser);
  await checkContrast(browser);
  await checkSweep(browser);
} finally {
  await browser.close();
}
console.log(`${checks} checks in the browser, ${failures} failed`);
process.exit(failures > 0 ? 1 : 0);
