#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What samples/run and tests/run do when something is missing, tried with stand-ins for apt-get, id and sudo, and what
# samples/run says without building anything.
set -uo pipefail
unset LOCKSTEP_PRESET  # of the build that is tested
root="$(readlink -f "$(dirname "${BASH_SOURCE[0]}")/../..")"
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT
n_failed=0

if ! bash -c 'root="$1"; source "$root/framework/cmake/setup.sh"; find_missing; [ "${#missing[@]}" -eq 0 ]' - "$root"; then
  echo "skipped: something is really missing here, so that nothing can be pretended"
  exit 77
fi

check() {  # check WHAT COMMAND...
  local what="$1"
  shift
  if ! "$@"; then
    echo "failed: $what"
    sed 's/^/  | /' "$place/said"
    n_failed=$((n_failed + 1))
  fi
}
said() { grep -qF -- "$1" "$place/said"; }
unsaid() { ! said "$1"; }
logged() { grep -qxF -- "$1" "$place/log"; }
code_is() { [ "$code" -eq "$1" ]; }
lines_are() { [ "$(wc -l <"$place/said")" -eq "$1" ]; }

stand_in() {  # stand_in NAME LINE: a program that runs this line
  mkdir -p "$place/bin"
  printf '#!/bin/sh\n%s\n' "$2" >"$place/bin/$1"
  chmod +x "$place/bin/$1"
}
stand_in apt-get "echo \"apt-get \$*\" >>'$place/log'"

set_up() {  # set_up MISSING...: runs the set-up with these packages held to be absent
  : >"$place/log"
  LOCKSTEP_PRETEND_MISSING="$*" PATH="$place/bin:$PATH" \
    bash -c 'root="$1"; source "$root/framework/cmake/setup.sh"; set_up' - "$root" >"$place/said" 2>&1
  code=$?
}
install="apt-get install --yes --no-install-recommends catch2 gnuplot-nox"

stand_in id 'echo 0'
set_up
check "nothing missing: quiet success" code_is 0
check "nothing missing: no word" lines_are 0
check "nothing missing: no apt-get" [ ! -s "$place/log" ]

set_up catch2 gnuplot-nox
check "root: success" code_is 0
check "root: lists are brought up to date" logged "apt-get update"
check "root: installs exactly what is missing" logged "$install"
check "root: says what" said "missing: catch2 gnuplot-nox; installing by apt-get"

stand_in id 'echo 1000'
stand_in sudo 'exit 1'
set_up catch2 gnuplot-nox
check "no rights: exit code" code_is 69
check "no rights: one sentence" lines_are 1
check "no rights: the command to type" said "please type: sudo $install"
check "no rights: no apt-get" [ ! -s "$place/log" ]

stand_in sudo 'shift; exec "$@"'
set_up catch2 gnuplot-nox
check "sudo: success" code_is 0
check "sudo: installs exactly what is missing" logged "$install"

stand_in id 'echo 0'
stand_in apt-get 'exit 100'
set_up catch2
check "apt-get fails: exit code" code_is 69
check "apt-get fails: next move" said "apt-get could not install catch2"

# What only a few tests use.
wish() {  # wish MISSING: asks for a package that is held to be absent
  : >"$place/log"
  LOCKSTEP_PRETEND_MISSING="$1" PATH="$place/bin:$PATH" \
    bash -c 'set -euo pipefail; root="$1"; source "$root/framework/cmake/setup.sh"; wish parallel sh "one test less"' - "$root" \
    >"$place/said" 2>&1
  code=$?
}
wish ""
check "wish, there: success" code_is 0
check "wish, there: no word" lines_are 0
wish parallel
check "wish, apt-get fails: success all the same" code_is 0
check "wish, apt-get fails: says what is lost" said "going on without parallel: one test less"
stand_in apt-get "echo \"apt-get \$*\" >>'$place/log'"
wish parallel
check "wish, root: success" code_is 0
check "wish, root: installs it" logged "apt-get install --yes --no-install-recommends parallel"

# samples/run through a symbolic link, from another folder.
ln -s "$root/samples/run" "$place/run_sample"
cd /
"$place/run_sample" >"$place/said" 2>&1
code=$?
check "list: success" code_is 0
for file in "$root"/samples/*.cpp "$root"/samples/scenes/*.json; do
  [ -e "$file" ] || continue
  name="$(basename "$file")"
  check "list: $name" said "  ${name%.*}"
done

for file in "$root"/samples/*.cpp; do
  [ -e "$file" ] || continue
  name="$(basename "$file" .cpp)"
  "$place/run_sample" "${name}q" >"$place/said" 2>&1
  code=$?
  check "unknown sample: exit code" code_is 2
  check "unknown sample: suggestion" said "there is no sample '${name}q'; did you mean '$name'?"
  break
done
"$place/run_sample" zzzzzzzzzzzz >"$place/said" 2>&1
code=$?
check "unlike any sample: exit code" code_is 2
check "unlike any sample: no suggestion" said "there is no sample 'zzzzzzzzzzzz'"

# samples/run takes an installed program that was built from this commit of a clean tree, and no other one.
if command -v git >/dev/null; then
  tree="$place/tree"
  mkdir -p "$tree/samples/scenes" "$tree/framework/cmake"
  cp "$root/samples/run" "$tree/samples"
  cp "$root/framework/cmake/setup.sh" "$tree/framework/cmake"
  echo '{}' >"$tree/samples/scenes/small.json"
  printf 'build\n' >"$tree/.gitignore"
  git -C "$tree" init -q
  git -C "$tree" add .
  git -C "$tree" -c user.name=t -c user.email=t@example.org commit -qm first
  run_small() {  # run_small COMMIT: with an installed program of this commit; without one cmake is called, which fails here
    stand_in lockstep "case \$1 in --version) echo 'lockstep 0.2.0 ($1)' ;; *) echo ran \"\$@\" ;; esac"
    stand_in cmake 'case $1 in --version) echo cmake version 3.25.0 ;; *) exit 1 ;; esac'
    PATH="$place/bin:$PATH" "$tree/samples/run" small >"$place/said" 2>&1
    code=$?
  }
  run_small "$(git -C "$tree" rev-parse --short=12 HEAD)"
  check "installed, same commit: success" code_is 0
  check "installed, same commit: says so" said "taking $place/bin/lockstep, which was built from this commit"
  check "installed, same commit: runs" said "ran run $tree/samples/scenes/small.json"
  run_small 0123456789ab
  check "installed, another commit: builds" said "configuring build/release"
  rm -rf "$tree/build"
  echo '{ }' >"$tree/samples/scenes/small.json"
  run_small "$(git -C "$tree" rev-parse --short=12 HEAD)"
  check "installed, changed tree: builds" said "configuring build/release"

  # A tree that is configured is left alone, until the presets are newer.
  touch "$tree/CMakePresets.json" "$tree/build/release/build.ninja" "$tree/build/release/configured"
  printf '%s\n' "CMAKE_HOME_DIRECTORY:INTERNAL=$tree" LOCKSTEP_BUILD_TESTS:BOOL=ON LOCKSTEP_BUILD_SAMPLES:BOOL=ON \
    >"$tree/build/release/CMakeCache.txt"
  run_small 0123456789ab
  check "configured: left alone" unsaid "configuring build/release"
  touch -d '+1 minute' "$tree/CMakePresets.json"
  run_small 0123456789ab
  check "newer presets: configured again" said "configuring build/release"
fi

[ "$n_failed" -eq 0 ]
