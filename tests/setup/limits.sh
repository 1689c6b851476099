#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# limits.sh CTEST BUILD_TREE: every test has a time limit of its own (property TIMEOUT), a minute at least, and every name
# in tests/limits.cmake.in is that of a test. Tried before on a folder with a test that has none.
set -uo pipefail
ctest="$1" build="$(readlink -f "$2")"
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT
n_failed=0
fault() { echo "$1"; n_failed=$((n_failed + 1)); }

# limits_of FOLDER: a line "SECONDS NAME" for each test that ctest finds there, 0 for one without a limit. ctest writes a
# test as an object with a key on each line, its name before its properties, which are indented further.
limits_of() {
  "$ctest" --test-dir "$1" --show-only=json-v1 | awk '
    function value(line) { sub(/^[^:]*: */, "", line); sub(/,$/, "", line); return line }
    function tell() { if (test != "") print limit, test; test = "" }
    /^ *"tests" *:/ { inside = 1 }
    inside && /^      "name" *:/ { tell(); test = value($0); gsub(/^"|"$/, "", test); limit = 0 }
    inside && /^          "name" *:/ { property = value($0) }
    inside && /^          "value" *:/ && property == "\"TIMEOUT\"" { limit = value($0) + 0 }
    END { tell() }'
}

mkdir "$place/planted"
printf 'add_test(free true)\nadd_test(held true)\nset_tests_properties(held PROPERTIES TIMEOUT 90)\n' \
  >"$place/planted/CTestTestfile.cmake"
if [ "$(limits_of "$place/planted")" != $'0 free\n90 held' ]; then
  fault "of the planted tests, 'free' without a limit and 'held' with 90 s, this was read:"
  limits_of "$place/planted"
fi

# A program that is not built stands in the list as one test, TARGET_NOT_BUILT-..., one whose cases are all skipped as
# PROGRAM.skipped; the cases are unknown.
# ctest keeps its log in the folder that it is given, so it gets another one than the run that this test is part of.
mkdir "$place/whole"
echo "subdirs(\"$build\")" >"$place/whole/CTestTestfile.cmake"
limits_of "$place/whole" >"$place/all.txt"
grep -v '_NOT_BUILT' "$place/all.txt" >"$place/limits.txt"
if [ "$(wc -l <"$place/limits.txt")" -lt 20 ]; then fault "ctest finds $(wc -l <"$place/limits.txt") tests in $build"; fi
while read -r seconds name; do
  fault "test '$name' has $seconds s as its time limit; give it 60 s or more (framework/cmake/limits.cmake)"
done < <(awk '$1 < 60' "$place/limits.txt")
sed 's/^[^ ]* //' "$place/limits.txt" >"$place/names.txt"
while IFS= read -r name; do
  if grep -q -e "test_${name%%.*}_NOT_BUILT" -e " ${name%%.*}[.]skipped$" "$place/all.txt"; then continue; fi
  grep -qxF -- "$name" "$place/names.txt" || fault "tests/limits.cmake.in: there is no test '$name'"
done < <(sed -n 's/^  "\(.*\)")\{0,1\}$/\1/p' "$here/../limits.cmake.in")
[ "$n_failed" -eq 0 ]
