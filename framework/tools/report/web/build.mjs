// SPDX-License-Identifier: BSD-3-Clause
// Bundles the page: script and style, put into page.html. `node build.mjs [file]`; the same sources give the same bytes.
import { build } from 'esbuild';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, 'dist', 'report.html');

async function bundle(options) {
  const result = await build({
    absWorkingDir: here,
    bundle: true,
    minify: true,
    write: false,
    charset: 'ascii',
    legalComments: 'none',
    logLevel: 'warning',
    target: ['chrome111', 'firefox113', 'safari16.4'],
    ...options,
  });
  return result.outputFiles[0].text.trim();
}

const script = await bundle({ entryPoints: ['src/main.js'], format: 'esm' });
const style = await bundle({
  stdin: { contents: "@import 'uplot/dist/uPlot.min.css'; @import './src/page.css';", loader: 'css', resolveDir: here },
});

// A script ends at the first "</script", wherever it stands.
const safe = script.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
let page = await readFile(join(here, 'src', 'page.html'), 'utf8');
for (const [mark, text] of [
  ['@style@', style],
  ['@script@', safe],
]) {
  const at = page.indexOf(mark);
  if (at < 0) throw new Error(`src/page.html lacks ${mark}`);
  page = page.slice(0, at) + text + page.slice(at + mark.length);
}
for (const mark of ['@lockstep-title@', '@lockstep-json@', '@lockstep-numbers@'])
  if (page.split(mark).length !== 2)
    throw new Error(`the page has ${page.split(mark).length - 1} times ${mark}; it needs it once`);
if (page.includes(')lockstep"')) throw new Error('the page holds )lockstep", which ends its text in the library');
await mkdir(dirname(out), { recursive: true });
await writeFile(out, page);
