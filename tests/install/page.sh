#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# page.sh BUILD_TREE COMPILER GENERATOR FLAGS PAGE [KIND...]: does in a scratch folder what a page says, word by word, with the
# installed package in install_test/prefix:
#   ```sh            is run
#   ```cpp a/b.cpp   (any language, then a path) becomes that file
#   ```text          each line has to stand in what the sh block before it printed
# With KINDs, a loop over kinds of plugin (`for kind in ...; do`) makes these alone.
set -euo pipefail
build="$1" compiler="$2" generator="$3" flags="$4" page="$5"
shift 5
place="$build/page_test/$#" prefix="$build/install_test/prefix"
rm -rf "$place"
mkdir -p "$place/work"
export PATH="$prefix/bin:$PATH" CMAKE_PREFIX_PATH="$prefix" CMAKE_GENERATOR="$generator" CXX="$compiler" CXXFLAGS="$flags"
unset LOCKSTEP_PLUGIN_PATH

# One file a block: <number>.sh, <number>.text, or <number>.file with its path in <number>.path.
awk -v out="$place" '
  /^```/ && !inside { inside = 1; n++; split(substr($0, 4), word, " ")
    kind = word[1]; path = word[2]
    if (path != "") { file = sprintf("%s/%03d.file", out, n); print path > sprintf("%s/%03d.path", out, n) }
    else file = sprintf("%s/%03d.%s", out, n, kind)
    printf "" > file; next }
  /^```/ { inside = 0; close(file); next }
  inside { print > file }' "$page"
if [ $# -gt 0 ]; then sed -i "s/^for kind in .*; do$/for kind in $*; do/" "$place"/*.sh; fi

cd "$place/work"
count=0
start=$SECONDS
for block in "$place"/[0-9][0-9][0-9].*; do
  name="${block%.*}"
  case "$block" in
    *.path) continue ;;
    *.file) path="$(cat "$name.path")"
            mkdir -p "$(dirname "$path")"
            cp "$block" "$path" ;;
    *.sh)   before=$SECONDS
            if ! bash -euo pipefail "$block" >"$place/said" 2>&1; then
              cat "$block" "$place/said" >&2
              echo "page: a step of $page failed" >&2
              exit 1
            fi
            echo "$((SECONDS - before)) s: $(head -1 "$block")" ;;
    *.text) while IFS= read -r line; do
              grep -qF -- "$line" "$place/said" || { cat "$place/said" >&2; echo "page: not printed: $line" >&2; exit 1; }
            done <"$block" ;;
    *)      echo "page: a block without a test in $page: $(head -1 "$block")" >&2
            exit 1 ;;
  esac
  count=$((count + 1))
done
[ "$count" -ge 10 ] || { echo "page: only $count blocks found in $page" >&2; exit 1; }
echo "page: $count blocks, $((SECONDS - start)) s of machine time"
rm -rf "$place"
