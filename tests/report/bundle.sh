#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# bundle.sh SOURCE: the committed page of reports is what its sources make, byte for byte, and its lock file names no
# registry. Without node or what `npm ci` installs the page is not made anew: exit code 77.
set -euo pipefail
web="$1/framework/tools/report/web"
if grep -nE '"resolved"|https?://[^"]*registry' "$web/package-lock.json"; then
  echo "package-lock.json names a registry; make it with npm install --omit-lockfile-registry-resolved" >&2
  exit 1
fi
command -v node >/dev/null || { echo "skipped: node is not installed (apt install nodejs npm)"; exit 77; }
for package in esbuild three uplot; do
  if [ ! -d "$web/node_modules/$package" ]; then
    echo "skipped: $package is not here (npm ci in framework/tools/report/web)"
    exit 77
  fi
done
made="$(mktemp)"
trap 'rm -f "$made"' EXIT
node "$web/build.mjs" "$made"
if ! cmp "$made" "$web/dist/report.html"; then
  echo "dist/report.html is not what the sources make; run npm run build in framework/tools/report/web" >&2
  exit 1
fi
