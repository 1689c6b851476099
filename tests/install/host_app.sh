#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# host_app.sh BUILD_TREE COMPILER GENERATOR FLAGS: builds samples/host_app, copied to a folder of its own, on the
# installed package, with the instructions of this very machine, and runs it.
set -euo pipefail
build="$1" compiler="$2" generator="$3" flags="$4"
root="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
place="$build/install_test/host_app"
rm -rf "$place"
mkdir -p "$place"
cp -r "$root/samples/host_app" "$place/source"
cmake -S "$place/source" -B "$place/build" -G "$generator" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags -march=native" \
  -DCMAKE_PREFIX_PATH="$build/install_test/prefix" >"$place/configure.txt"
cmake --build "$place/build"
cd /
"$place/build/host_app"
rm -rf "$place"
