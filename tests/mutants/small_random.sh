#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# small_random.sh RANDOM: tests/mutants/random in a tree of two sources and two test cases: it plants, finds, lists the slips
# that survive, leaves out what is equal or not reached, goes on from what it has written, and leaves the sources alone.
set -uo pipefail
random="$1"
for tool in perl cmake ninja gcov; do
  command -v $tool >/dev/null || { echo "skipped: there is no $tool"; exit 77; }
done
place="$(mktemp -d -t small_XXXXXX)"
trap 'rm -rf "$place"' EXIT
n_failed=0
fault() { echo "$1"; n_failed=$((n_failed + 1)); }
root="$place/tree"
mkdir -p "$root/tests/mutants" "$root/framework/small/include"
cp "$random" "$(dirname "$random")/reach.cpp" "$root/tests/mutants/"
printf 'small | | the only wing\n  framework/small | the only room |\n' >"$root/framework/layout.txt"
# Of held() every slip is found; of loose() none, as its test asks for nothing that can be wrong; never() is not called.
cat >"$root/framework/small/held.cpp" <<'SOURCE'
int held(int a, int b) {
  return a - b;
}
SOURCE
cat >"$root/framework/small/loose.cpp" <<'SOURCE'
// 3 + 4 in a comment, and "5 - 6" in a text, are no code.
int loose(int a, int b) {
  return a + b;
}
int never(int a, int b) {
  return a * 7;
}
int same(int a) {
  return a * 2 == 2 * a;
}
SOURCE
cat >"$root/framework/small/test.cpp" <<'TEST'
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
int held(int a, int b), loose(int a, int b);
// As a program of Catch2: "--list-test-names-only" lists the cases, "-f FILE" runs those that it names.
int main(int n, char** words) {
  if (std::strcmp(words[1], "--list-test-names-only") == 0)
    return std::puts("held, and \"so\"\nloose\nbroken\nidle"), 0;
  std::ifstream names(words[n - 1]);
  for (std::string name; std::getline(names, name);) {
    if (name == "broken") return 3;
    if (name == "idle") continue;
    if (name != "loose" && name != "held\\, and \\\"so\\\"") return 4;
    if (!(name == "loose" ? loose(1, 2) > -100 : held(7, 3) == 4 && held(3, 7) == -4))
      return std::printf("%s\n%s\n", std::string(79, '-').c_str(), name.c_str()), 2;
  }
}
TEST
cat >"$root/CMakeLists.txt" <<'LISTS'
cmake_minimum_required(VERSION 3.25)
project(small LANGUAGES CXX)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
add_library(lockstep_core SHARED framework/small/held.cpp framework/small/loose.cpp)
target_include_directories(lockstep_core PRIVATE framework/small/include)
set_target_properties(lockstep_core PROPERTIES UNITY_BUILD ON)
add_executable(test_unit framework/small/test.cpp)
target_link_libraries(test_unit PRIVATE lockstep_core)
LISTS
# As with ccache, which stands before the compiler and is none.
printf '#!/bin/sh\nexec "$@"\n' >"$place/ccache"
chmod +x "$place/ccache"
if ! { cmake -S "$root" -B "$root/build/release" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_STANDARD=17 \
  -DCMAKE_CXX_COMPILER_LAUNCHER="$place/ccache" &&
  cmake --build "$root/build/release"; } >"$place/log" 2>&1; then
  cat "$place/log"
  exit 1
fi
(cd "$root" && find framework build/release/lib build/release/bin -type f -exec cksum {} +) >"$place/before"

"$root/tests/mutants/random" --room small --seed 3 --count 8 >"$place/said" 2>&1
[ $? -eq 1 ] || fault "a run with many survivors did not end by 1"
says() { grep -q -e "$1" "$place/said" || fault "it does not say: $1"; }
says '^left out, as it fails without a slip: broken$'
says '^framework/small/held.cpp:2: [a-z]*: return a - b;  ->  return '
says '^    caught by test_unit: held'
says '^framework/small/loose.cpp:3: [a-z]*: return a + b;  ->  return '
says '^    SURVIVED'
says 'in small were caught'
grep -A1 '^framework/small/held' "$place/said" | grep -q SURVIVED && fault "a slip in held() survived"
grep -A1 '^framework/small/loose' "$place/said" | grep -q caught && fault "a slip in loose() was caught"
grep -q 'loose.cpp:1:' "$place/said" && fault "a comment was changed"
grep -A1 'loose.cpp:6:' "$place/said" | grep -q -e caught -e SURVIVED && fault "a slip that no test reaches was counted"
(cd "$root" && find framework build/release/lib build/release/bin -type f -exec cksum {} +) | cmp -s - "$place/before" ||
  fault "sources, library or tests are not what they were"

# Again: what was tried is not tried again, and the same slips are drawn.
grep -v -e ' s)$' -e '^each test is tried' "$place/said" >"$place/first"
results="$(cat "$root"/build/random/small.3)"
"$root/tests/mutants/random" --room small --seed 3 --count 8 >"$place/said" 2>&1
grep -v ' s)$' "$place/said" | cmp -s - "$place/first" || fault "a second run drew other slips"
[ "$results" = "$(cat "$root"/build/random/small.3)" ] || fault "a second run tried again what was tried"
# A survivor that was read and found equal in effect is not counted.
slip="$(sed -n 's/^survived\t//p' <<<"$results" | head -1)"
sed -E 's/:[0-9]+:/:/' <<<"$slip" >"$root/tests/mutants/equal.txt"
"$root/tests/mutants/random" --room small --seed 3 --count 8 >"$place/said" 2>&1
grep -F -A1 "$slip" "$place/said" | grep -q 'equal in effect' || fault "a slip that is listed as equal was counted"

"$root/tests/mutants/random" --room framework/small/held.cpp --seed 3 --count 2 --only-survivors >"$place/said" 2>&1 ||
  fault "a file of which all slips are caught did not end by 0"
grep -q 'caught by' "$place/said" && fault "--only-survivors lists others"
"$root/tests/mutants/random" --room smal >"$place/said" 2>&1 && fault "a room that is not there was taken"
says "there is no room 'smal'; framework/layout.txt has the wings small"
mkdir "$place/tree.h"
cp -r "$root/tests" "$place/tree.h/"
"$place/tree.h/tests/mutants/random" --room small >"$place/said" 2>&1 && fault "a path that the hooks leave out was taken"
says "with '.h' in their path; move the tree"
if [ "$n_failed" -gt 0 ]; then sed 's/^/  | /' "$place/first"; fi
[ "$n_failed" -eq 0 ]
