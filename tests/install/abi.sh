#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# abi.sh BUILD           compares the shared libraries of a build with debug information (preset dev, g++ of Debian 12) with the
#                        stored description of their binary interface; fails if a program built before would not run with them
# abi.sh BUILD --write   stores their description: for a release, or after kAbiNumber was raised
# 77: no abidiff here.
set -euo pipefail
for tool in abidw abidiff xz; do
  command -v "$tool" >/dev/null || { echo "skipped: there is no $tool (packages abigail-tools and xz-utils)" && exit 77; }
done
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/abi"
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT

describe() {  # library file
  abidw --exported-interfaces-only --no-comp-dir-path --no-corpus-path --no-show-locs --suppressions "$here/suppressed.ini" \
    "$1" >"$2"
}
compare() {  # description library
  describe "$2" "$place/now.abi"
  abidiff --no-added-syms "$1" "$place/now.abi"
}

# A planted change of a type and a missing function are found; a function more is none.
mkdir -p "$place/framework/include/lockstep"
plant() {  # name members functions
  printf 'namespace lockstep { struct Planted { %s }; }\n' "$2" >"$place/framework/include/lockstep/planted.h"
  printf '#include "framework/include/lockstep/planted.h"\nnamespace lockstep { %s }\n' "$3" >"$place/$1.cpp"
  c++ -g -shared -fPIC -I "$place" -o "$place/$1.so" "$place/$1.cpp"
}
kept='double kept(Planted& p) { return p.x; }' gone='int gone() { return 1; }' fresh='int fresh() { return 2; }'
plant before 'double x;' "$kept $gone"
describe "$place/before.so" "$place/before.abi"
plant same 'double x;' "$kept $gone $fresh"
compare "$place/before.abi" "$place/same.so" >/dev/null || { echo "a function more is reported" && exit 1; }
for change in 'float x; int y;|'"$kept $gone" "double x;|$kept"; do
  plant after "${change%%|*}" "${change#*|}"
  if compare "$place/before.abi" "$place/after.so" >/dev/null; then echo "not found: $change" && exit 1; fi
done

failed=0 seen=0
for library in "$1"/lib/liblockstep*.so; do
  name="$(basename "$library" .so)" seen=1
  if [ "${2:-}" = --write ]; then
    describe "$library" "$place/$name.abi"
    xz -9 -c "$place/$name.abi" >"$here/$name.abi.xz"
    continue
  fi
  xz -dc "$here/$name.abi.xz" >"$place/$name.abi"
  if ! compare "$place/$name.abi" "$library" >"$place/changes"; then
    case "$name" in
      liblockstep-c) advice="the interface of C is stable: keep what is there, and add functions" ;;
      *) advice="raise kAbiNumber, and run abi.sh $1 --write" ;;
    esac
    printf '%s is not compatible with its description; %s:\n' "$name" "$advice"
    head -n 60 "$place/changes"
    failed=1
  fi
done
[ "$seen" = 1 ] || { echo "$1/lib has no shared library of lockstep" && exit 1; }
exit "$failed"
