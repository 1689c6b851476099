#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# links.sh BUILD_TREE CMAKE: installs the pages into a scratch folder, as package lockstep-doc has them, and follows each
# local link of each page there.
set -euo pipefail
build="$1" cmake="$2"
place="$build/links_test"
rm -rf "$place"
"$cmake" --install "$build" --component doc --prefix "$place" >/dev/null
count=0 dead=0
while read -r page; do
  # Outside of code and comments, which have brackets and parentheses of their own.
  while read -r link; do
    case "$link" in http:* | https:* | mailto:* | "") continue ;; esac
    count=$((count + 1))
    [ -e "$(dirname "$page")/$link" ] && continue
    echo "${page#"$place"/} leads to $link, which is not there"
    dead=$((dead + 1))
  done < <(awk '/<!--/ { note = 1 } /^ *```/ { code = !code; next } !code && !note; /-->/ { note = 0 }' "$page" | sed 's/`[^`]*`//g' |
    { grep -oE '\]\([^)#[:space:]]*' || true; } | sed 's/^](//')
done < <(find "$place" -name '*.md')
echo "$count links, $dead of them dead"
test "$dead" -eq 0
test "$count" -ge 100
rm -rf "$place"
