#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# client.sh BUILD_TREE COMPILER GENERATOR FLAGS: a project in a folder of its own finds the package after it was moved,
# builds a program and a plugin, with make where there is one, and the installed program takes the plugin.
set -euo pipefail
build="$1" compiler="$2" generator="$3" flags="$4"
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
place="$build/install_test/client"
rm -rf "$place"
mkdir -p "$place"
if command -v make >/dev/null; then generator="Unix Makefiles"; fi

cp -a "$build/install_test/prefix" "$place/moved"
cp -r "$here/client" "$place/source"
cmake -S "$place/source" -B "$place/build" -G "$generator" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" -DCMAKE_PREFIX_PATH="$place/moved"
cmake --build "$place/build"
"$place/build/client" "$place/moved" "$place/build/plugins"
"$place/moved/bin/lockstep" describe client_law --plugin "$place/build/plugins/client_plugin.so" | grep client_plugin >/dev/null
# The paths of the pages name the samples of the installation, with the files beside them.
(cd "$place" && moved/bin/lockstep run samples/scenes/stewart.json --until 0.1 --quiet --record stewart.csv &&
  moved/bin/lockstep assemble samples/scenes/four_bar.json >/dev/null)
test -s "$place/stewart.csv"
if (cd "$place" && moved/bin/lockstep run no_such.json) 2>"$place/missing.txt"; then exit 1; fi
grep -q "samples are in .*/moved/share/lockstep/scenes" "$place/missing.txt"

if cmake -S "$place/source" -B "$place/later" -DCMAKE_CXX_COMPILER="$compiler" -DWANTED=9.1 \
  -DCMAKE_PREFIX_PATH="$place/moved" >"$place/later.txt" 2>&1; then
  echo "find_package(lockstep 9.1) found this version"
  exit 1
fi
grep -q 'requested version "9.1"' "$place/later.txt"
rm -rf "$place"
