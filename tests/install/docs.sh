#!/usr/bin/env bash
# docs.sh SOURCE BUILD_TREE: builds the pages and the API by Doxygen and fails on a broken link or a public class, struct or
# function without a word of documentation. 77: no Doxygen here.
set -uo pipefail
source="$1" build="$2"
command -v doxygen >/dev/null || { echo "skipped: there is no doxygen"; exit 77; }
cd "$source" || exit 1
mkdir -p "$build/docs"
doxygen "$build/Doxyfile" 2>"$build/docs/warnings.txt" || { cat "$build/docs/warnings.txt"; exit 1; }
wrong="$(grep -vE 'found more than one .mainpage|is not documented|Internal inconsistency' "$build/docs/warnings.txt" | grep . || true)"
bare="$(grep -E 'Compound .* is not documented' "$build/docs/warnings.txt" || true)"
test -s "$build/docs/html/index.html" || { echo "no page was written"; exit 1; }
if [ -n "$wrong$bare" ]; then
  printf '%s\n' "$wrong" "$bare" | sed "s|$source/||"
  exit 1
fi
echo "docs: $(find "$build/docs/html" -name '*.html' | wc -l) pages"
