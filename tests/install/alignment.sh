#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# alignment.sh BUILD_TREE COMPILER GENERATOR FLAGS: a client with the settings of lockstep.pc links, whatever its
# -march; one with others does not, and the linker names the setting. 77: no pkg-config here.
set -uo pipefail
build="$1" compiler="$2" flags="$4"
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
prefix="$build/install_test/prefix" place="$build/install_test/alignment"
if ! command -v pkg-config >/dev/null; then
  echo "skipped: there is no pkg-config"
  exit 77
fi
rm -rf "$place"
mkdir -p "$place"
export PKG_CONFIG_PATH
PKG_CONFIG_PATH="$(dirname "$(find "$prefix" -name lockstep.pc)")${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}"
settings="$(pkg-config --cflags lockstep)" || exit 1
libraries="$(pkg-config --libs lockstep)" || exit 1
folder="$(pkg-config --variable=libdir lockstep)"
failed=0

# links WORDS...: compiles with these words after those of the package, links and runs.
links() {
  if ! "$compiler" -std=c++20 $flags $settings "$@" "$here/alignment/client.cpp" -o "$place/client" \
    $libraries "-Wl,-rpath,$folder" >"$place/words.txt" 2>&1 || ! "$place/client" >>"$place/words.txt" 2>&1; then
    echo "with '$*' it should have linked and run:"
    tail -n 20 "$place/words.txt"
    failed=1
  fi
}

# refused NAME WORDS...: with these words it must not link, and the linker's text must hold the name. Beside it stands a
# file that is right, and unused sections are thrown away: neither may hide what is wrong.
refused() {
  local name="$1"
  shift
  if "$compiler" -std=c++20 $flags "$@" -w -ffunction-sections -fdata-sections "$place/right.o" \
    "$place/wrong.cpp" -o "$place/client" $libraries -Wl,--gc-sections >"$place/words.txt" 2>&1; then
    echo "with '$*' it should not have linked"
    failed=1
  elif ! grep -q -F "$name" "$place/words.txt"; then
    echo "with '$*' the linker does not name $name:"
    tail -n 20 "$place/words.txt"
    failed=1
  fi
}

echo '#include <lockstep/math.h>' >"$place/right.cpp"
cp "$place/right.cpp" "$place/wrong.cpp"
echo 'int main() {}' >>"$place/right.cpp"
"$compiler" -std=c++20 $flags $settings -c "$place/right.cpp" -o "$place/right.o" || exit 1

links
links -march=native -O2
refused 'built_with::eigen_max_align_bytes<32>' $settings -UEIGEN_MAX_ALIGN_BYTES -DEIGEN_MAX_ALIGN_BYTES=32
refused 'built_with::eigen_max_static_align_bytes<0>' $settings -DEIGEN_MAX_STATIC_ALIGN_BYTES=0
refused 'built_with::eigen_malloc_already_aligned<1>' $settings -UEIGEN_MALLOC_ALREADY_ALIGNED \
  -DEIGEN_MALLOC_ALREADY_ALIGNED=1
refused 'built_with::glibcxx_debug<1>' $settings -D_GLIBCXX_DEBUG
rm -rf "$place"
exit "$failed"
