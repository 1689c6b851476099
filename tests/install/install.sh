#!/usr/bin/env bash
# install.sh BUILD_TREE COMPILER FLAGS GENERATOR: installs to a prefix of its own, then configures, builds and runs a client there.
set -euo pipefail
build="$1" compiler="$2" flags="$3" generator="$4"
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
place="$build/install_test"
rm -rf "$place"

cmake --install "$build" --prefix "$place/prefix" >/dev/null
cmake -S "$here/client" -B "$place/client" -G "$generator" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_CXX_FLAGS="$flags" -DCMAKE_PREFIX_PATH="$place/prefix"
cmake --build "$place/client"
"$place/client/client"
test -e "$place/client/plugins/client_plugin.so"
if [ -e "$here/../../framework/runner/main.cpp" ]; then "$place/prefix/bin/lockstep" --help >/dev/null; fi
rm -rf "$place"
