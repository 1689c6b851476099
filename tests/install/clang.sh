#!/usr/bin/env bash
# clang.sh BUILD_TREE: the library, the program and the plugins once more with clang++, in BUILD_TREE, installed from there;
# then what new_plugin.sh asks of a plugin of each kind, built by clang++ against that host, and the page.
set -euo pipefail
build="$1"
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
root="$(dirname "$(dirname "$here")")"
command -v clang++ >/dev/null || { echo "clang.sh: clang++ was not found (Debian: clang)"; exit 77; }
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ -DLOCKSTEP_BUILD_TESTS=OFF \
  -DLOCKSTEP_BUILD_SAMPLES=OFF
cmake --build "$build"
"$here/prefix.sh" "$build"
"$here/new_plugin.sh" "$build" clang++ Ninja ""
"$here/page.sh" "$build" clang++ Ninja "" "$root/plugins/README.md"
echo "clang.sh: plugins of all four kinds build and pass against a host that clang++ built"
