#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# site.sh SOURCE BUILD_TREE [pages]: builds the site in BUILD_TREE/docs/html: the pages, the API, and a gallery with a
# report and a picture of each sample; with "pages" without the gallery. Fails on every warning of Doxygen, on a public
# name without a word of documentation, and on every link that leads nowhere. 77: no Doxygen here.
set -euo pipefail
source="$1" build="$2" only="${3:-}"
command -v doxygen >/dev/null || { echo "skipped: there is no doxygen"; exit 77; }
program="$build/bin/lockstep" gallery="$build/docs/gallery" html="$build/docs/html" page="$build/docs/gallery.md"
export LOCKSTEP_PLUGIN_PATH="$build/plugins"
rm -rf "$gallery" "$html"
mkdir -p "$gallery"

# The gallery: a page of links and pictures, in the order of the names.
title_of() { sed -n 's/.*"title" *: *"\(\([^"\\]\|\\.\)*\)".*/\1/p' "$1" | head -n 1; }
browser="$(command -v chromium || command -v chromium-browser || true)"
picture_of() {  # of the first frame of a report; without a browser the plot stays
  [ -n "$browser" ] || return 0
  timeout 60 "$browser" --headless --no-sandbox --hide-scrollbars --window-size=1200,700 --virtual-time-budget=4000 \
    --user-data-dir="$build/docs/browser" --screenshot="$gallery/$1.png" "file://$gallery/$1.html" >/dev/null 2>&1 || true
}
make_gallery() {
  {
    echo "# Gallery"
    echo "Each sample of \`samples/scenes\` with its report, which moves: \`lockstep report samples/scenes/NAME.json --open\` makes it."
  } >"$page"
  for scene in "$source"/samples/scenes/*.json; do
    name="$(basename "$scene" .json)"
    code=0
    "$program" report "$scene" --quiet --record "$gallery/$name.csv" --out "$gallery/$name.html" || code=$?
    if [ "$code" -ne 0 ]; then echo "$name: its report ended with $code"; exit 1; fi
    picture_of "$name"
    {
      printf '\n## %s\n%s\n\n' "$name" "$(title_of "$scene")"
      if [ -s "$gallery/$name.png" ]; then
        printf '<a href="gallery/%s.html"><img src="gallery/%s.png" alt="%s" width="600"></a>\n\n' "$name" "$name" "$name"
      fi
      printf '<a href="gallery/%s.html">Report</a>, <a href="gallery/%s.csv">table</a>\n' "$name" "$name"
    } >>"$page"
  done
  rm -rf "$build/docs/browser" "$gallery"/*.svg
}
inputs=""
if [ "$only" != pages ]; then make_gallery; inputs="INPUT += $page"; fi

cd "$source"
{ cat "$build/Doxyfile"; printf '%s\n' "$inputs" 'FILTER_PATTERNS = *.md=tests/pages/anchors'; } | doxygen - 2>"$build/docs/warnings.txt" || { cat "$build/docs/warnings.txt"; exit 1; }
# Passed over: specialisations of Eigen's templates have no scope that Doxygen knows.
expected='Internal inconsistency: scope for class Eigen::'
wrong="$(grep -vE "$expected" "$build/docs/warnings.txt" | grep . | sort -u || true)"
test -s "$html/index.html" || { echo "no page was written"; exit 1; }
# Only in a documented namespace does Doxygen report functions and types.
test -s "$html/namespacelockstep.html" || { echo "lockstep.h does not document the namespace"; exit 1; }
if [ -n "$wrong" ]; then
  printf '%s\n' "$wrong" | sed "s|$source/||g"
  exit 1
fi
mv "$gallery" "$html/gallery"

cd "$html"
"$source/tests/pages/anchors" --html ./md_*.html index.html
# Marks of Markdown that Doxygen left in the words of a page, but for blocks of code.
marks="$(perl -0777 -ne 's{<div class="fragment">.*?</div><!-- fragment -->|<pre.*?</pre>|<!--.*?-->|<[^>]*>}{}gs;
  while (/^(.*(?:`|\\ilinebr).*)$/mg) { print "$ARGV: $1\n" }' ./md_*.html index.html)"
if [ -n "$marks" ]; then printf 'marks are left on the page:\n%s\n' "$marks"; exit 1; fi
# Pairs of a page and a local link in it that leads to no file.
lost() {
  grep -oHE '(href|src)="[^"#]+' ./*.html | sed -E 's/^([^:]+):(href|src)="/\1 /' | sort -u |
    while read -r from to; do
      case "$to" in
        http:*|https:*|mailto:*|javascript:*|data:*) continue ;;
        /*) echo "$from $to"; continue ;;  # a place on this machine
      esac
      [ -e "$(printf '%b' "${to//%/\\x}")" ] || echo "$from $to"
    done
}
# Doxygen follows the links between pages, and leaves those to pictures and other files of the source.
lost | while read -r from to; do
  name="$(basename "$to")"
  case "$name" in
    *.md)
      path="${to#"$source/"}" path="${path##*../}" path="${path%.md}"
      for page in "md_${path//\//_}.html" "md_framework_docs_${name%.md}.html"; do
        if [ -e "$page" ]; then sed -i "s|\"$to|\"$page|g" "$from"; break; fi
      done
      ;;
    *)
      file="$(find "$source/framework" "$source/tests" "$source/samples" -name "$name" -type f | head -n 1)"
      if [ -n "$file" ]; then cp "$file" . && sed -i "s|\"$to\"|\"$name\"|g" "$from"; fi
      ;;
  esac
done
left="$(lost | sed 's/ / leads to /; s/$/, which is not there/')"
if [ -n "$left" ]; then printf '%s\n' "$left" | head -n 40; exit 1; fi
echo "site: $(find . -name '*.html' | wc -l) pages in $html"
