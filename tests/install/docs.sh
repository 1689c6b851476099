#!/usr/bin/env bash
# docs.sh SOURCE BUILD_TREE: builds the pages and the API by Doxygen and fails on every warning: a broken link, or a
# public name without a word of documentation. 77: no Doxygen here.
set -uo pipefail
source="$1" build="$2"
command -v doxygen >/dev/null || { echo "skipped: there is no doxygen"; exit 77; }
cd "$source" || exit 1
rm -rf "$build/docs/html" && mkdir -p "$build/docs"
doxygen "$build/Doxyfile" 2>"$build/docs/warnings.txt" || { cat "$build/docs/warnings.txt"; exit 1; }
# Passed over: each README.md is a front page to Doxygen; specialisations of Eigen's templates have no scope it knows.
expected='found more than one .mainpage|Internal inconsistency: scope for class Eigen::'
wrong="$(grep -vE "$expected" "$build/docs/warnings.txt" | grep . | sort -u || true)"
test -s "$build/docs/html/index.html" || { echo "no page was written"; exit 1; }
# Only in a documented namespace does Doxygen report functions and types.
test -s "$build/docs/html/namespacelockstep.html" || { echo "lockstep.h does not document the namespace"; exit 1; }
if [ -n "$wrong" ]; then
  printf '%s\n' "$wrong" | sed "s|$source/||g"
  exit 1
fi
echo "docs: $(find "$build/docs/html" -name '*.html' | wc -l) pages"
