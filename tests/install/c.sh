#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# c.sh BUILD_TREE FLAGS: builds samples/hosts/c and samples/hosts/fortran on the installed package, by pkg-config and by CMake, and
# runs them. 77: no C compiler or no pkg-config here, or FLAGS ask for checks that programs in C are not linked with.
set -euo pipefail
case "$2" in *-fsanitize*) echo "skipped: the library is built with checks" && exit 77 ;; esac
build="$1"
root="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
place="$build/install_test/c" prefix="$build/install_test/prefix"
for tool in cc pkg-config; do command -v "$tool" >/dev/null || { echo "skipped: there is no $tool" && exit 77; }; done
rm -rf "$place"
mkdir -p "$place/project"
export PKG_CONFIG_PATH
PKG_CONFIG_PATH="$(dirname "$(find "$prefix" -name lockstep-c.pc)")"
libdir="$(pkg-config --variable=libdir lockstep-c)"
export LD_LIBRARY_PATH="$libdir"
scene="$root/samples/scenes/pendulum.json"

for source in "$root"/samples/hosts/c/*.c; do
  # shellcheck disable=SC2046
  cc -std=c11 -pedantic -Wall -Wextra -Werror "$source" -o "$place/program" $(pkg-config --cflags --libs lockstep-c) -lm
  "$place/program" "$scene" >/dev/null
done
if command -v gfortran >/dev/null; then
  # shellcheck disable=SC2046
  gfortran -J "$place" "$root"/samples/hosts/fortran/{lockstep,pendulum}.f90 -o "$place/program" $(pkg-config --libs lockstep-c)
  "$place/program" "$scene" >/dev/null
fi

cat >"$place/project/CMakeLists.txt" <<'end'
cmake_minimum_required(VERSION 3.25)
project(pendulum LANGUAGES C)
find_package(lockstep-c 1 REQUIRED)
add_executable(pendulum pendulum.c)
target_link_libraries(pendulum PRIVATE lockstep::c)
end
cp "$root/samples/hosts/c/pendulum.c" "$place/project"
unset LD_LIBRARY_PATH
cmake -S "$place/project" -B "$place/build" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$place/build" >/dev/null
"$place/build/pendulum" "$scene" >/dev/null
rm -rf "$place"
