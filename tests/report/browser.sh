#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# browser.sh LOCKSTEP SCENES FOLDER: reports in a real browser. Without node or chromium: exit code 77.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
command -v node >/dev/null || { echo "skipped: node is not installed (apt install nodejs)"; exit 77; }
chromium="$(command -v chromium || command -v chromium-browser || true)"
[ -n "$chromium" ] || { echo "skipped: chromium is not installed (apt install chromium)"; exit 77; }
exec node "$here/browser.mjs" "$chromium" "$@"
