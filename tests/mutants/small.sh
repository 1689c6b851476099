#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# small.sh RUN: tests/mutants/run in a tree of one source, with and without git: which slips are found, which are not,
# and what is said of those that cannot tell. The tree's one test is right where value() is 3.
set -uo pipefail
run="$1"
for tool in patch cmake ninja; do
  command -v $tool >/dev/null || { echo "skipped: there is no $tool"; exit 77; }
done
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT
n_failed=0
fault() { echo "$1"; n_failed=$((n_failed + 1)); }
root="$place/tree"
mkdir -p "$root/tests/mutants" "$root/build/release"
cp "$run" "$root/tests/mutants/run"
echo 'int value() { return 3; }' >"$root/value.cpp"
cat >"$root/test.cpp" <<'TEST'
#include <cstdio>
#include <cstring>
int value();
int main(int, char** words) {
  if (std::strcmp(words[1], "always*") == 0) return 1;
  if (std::strcmp(words[1], "three*") == 0) return value() == 3 ? 0 : 1;
  std::puts("No test cases matched");
}
TEST
cat >"$root/CMakeLists.txt" <<'LISTS'
cmake_minimum_required(VERSION 3.25)
project(small LANGUAGES CXX)
option(LOCKSTEP_BUILD_SAMPLES "as in the tree that this one stands for" ON)
option(LOCKSTEP_UNITY "likewise" OFF)
file(GLOB sources CONFIGURE_DEPENDS *.cpp)
add_executable(test_small ${sources})
set_target_properties(test_small PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
add_custom_target(lockstep_program)
LISTS

slip() {  # slip NAME TESTS LINE: value.cpp becomes this line
  printf 'What: %s\nTests: test_small %s\n\n--- a/value.cpp\n+++ b/value.cpp\n@@ -1 +1 @@\n-%s\n+%s\n' "$1" "$2" \
    'int value() { return 3; }' "$3" >"$root/tests/mutants/$1.patch"
}
slip a_two 'three*' 'int value() { return 2; }'
slip b_sum 'three*' 'int value() { return 1 + 2; }'
slip c_broken 'three*' 'int value() { return; }'
slip d_always 'always*' 'int value() { return 4; }'
slip e_absent 'four*' 'int value() { return 4; }'
a='a_two: found by test_small "three*"'
b='b_sum: SURVIVED test_small "three*": b_sum'
c='c_broken: does not build'
d='d_always: test_small "always*" fails without the slip'
e='e_absent: test_small has no test "four*"'

# says CODE WORDS... -- LINE...: run with these words ends so, and its lines begin so, these and no others.
says() {
  local code="$1" words=() got k=0
  shift
  while [ "$1" != -- ]; do words+=("$1"); shift; done
  shift
  timeout 50 "$root/tests/mutants/run" "${words[@]}" >"$place/said" 2>&1
  got=$?
  mapfile -t lines <"$place/said"
  local right=yes
  if [ $got -ne "$code" ] || [ ${#lines[@]} -ne $# ]; then right=no; fi
  for line in "$@"; do
    case "${lines[k]:-}" in "$line"*) ;; *) right=no ;; esac
    k=$((k + 1))
  done
  if [ $right = no ]; then
    echo "run ${words[*]} ended by $got instead of $code, or said other lines than: $*"
    sed 's/^/  | /' "$place/said"
    n_failed=$((n_failed + 1))
  fi
}
copy="$root/build/mutants/tree"

says 1 -- "$a" "$b" "$c" "$d" "$e" "1 of 5 slips were found"
cmp -s "$root/value.cpp" "$copy/value.cpp" || fault "the last slip stayed in the copy"
says 0 a_two -- "$a" "1 of 1 slips were found"
says 1 --share 1/2 -- "$a" "$c" "$e" "1 of 3 slips were found"
says 1 --share 2/2 -- "$b" "$d" "0 of 2 slips were found"
for share in 3/2 0/2 2 ""; do says 2 --share "$share" -- "--share $share: K/N is expected"; done
says 2 a_tow -- "there is no slip 'a_tow'"
says 0 --dry -- "5 of 5 slips fit the sources"

# What a run that was killed left, and a source that is gone, do not stay; a build is no source.
echo 'int value() { return 2; }' >"$copy/value.cpp"
echo 'int value() { return 3; }' >"$copy/gone.cpp"
says 0 a_two -- "$a" "1 of 1 slips were found"
[ ! -e "$copy/gone.cpp" ] && [ ! -e "$copy/build" ] || fault "the copy has files that are no sources"

# With git: what it ignores is no source, what it does not know yet is one.
if command -v git >/dev/null; then
  git -C "$root" -c init.defaultBranch=main init -q
  printf 'build/\nignored.cpp\n' >"$root/.gitignore"
  git -C "$root" add value.cpp CMakeLists.txt .gitignore
  echo 'int value() { return 3; }' >"$root/ignored.cpp"
  says 0 a_two -- "$a" "1 of 1 slips were found"
  [ ! -e "$copy/ignored.cpp" ] && [ -e "$copy/test.cpp" ] || fault "the copy is not what git tells"
fi

# A slip that no longer fits.
echo 'int value() { return 1 + 1 + 1; }' >"$root/value.cpp"
says 1 --dry a_two -- "a_two: does not fit the sources" "0 of 1 slips fit the sources"
says 1 a_two -- "a_two: does not fit the sources" "0 of 1 slips were found"
cmp -s "$root/value.cpp" "$copy/value.cpp" || fault "a slip that does not fit changed the copy"
[ ! -e "$copy/value.cpp.rej" ] || fault "a slip that does not fit left its rejects in the copy"

# One that fits beside other lines only, which may be another place.
printf '%s\n' '// one' 'int value() { return 3; }' '// two' >"$root/value.cpp"
printf 'What: f\nTests: test_small three*\n\n--- a/value.cpp\n+++ b/value.cpp\n@@ -1,3 +1,3 @@\n // one\n-%s\n+%s\n // other\n' \
  'int value() { return 3; }' 'int value() { return 2; }' >"$root/tests/mutants/f_fuzz.patch"
says 1 --dry f_fuzz -- "f_fuzz: does not fit the sources" "0 of 1 slips fit the sources"
says 1 f_fuzz -- "f_fuzz: does not fit the sources" "0 of 1 slips were found"
[ "$n_failed" -eq 0 ]
