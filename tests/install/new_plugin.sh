#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# new_plugin.sh BUILD_TREE COMPILER GENERATOR FLAGS KIND...: with the installed package in install_test/prefix,
# `lockstep new-plugin` writes a plugin of each of these kinds, which builds, passes its own tests, and is seen by list, describe, schema and a scene.
set -euo pipefail
unset LOCKSTEP_PLUGIN_PATH
build="$1" compiler="$2" generator="$3" flags="$4"
shift 4
place="$build/new_plugin_test/$#" prefix="$build/install_test/prefix"
rm -rf "$place"
mkdir -p "$place"
lockstep="$prefix/bin/lockstep"

for kind in "$@"; do
  name="my_$kind"
  folder="$place/$name"
  "$lockstep" new-plugin "$kind" "$name" --into "$place" >/dev/null
  if grep -rniE 'template_|Template(Joint|Coupling|Law|Force|Integrator)' "$folder"; then
    echo "$name: the template's own name is left in it" >&2
    exit 1
  fi
  cmake -S "$folder" -B "$folder/build" -G "$generator" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags -Wall -Wextra -Werror" \
    -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
  cmake --build "$folder/build" >"$place/log" 2>&1 || { cat "$place/log" >&2; exit 1; }
  (cd "$folder/build" && ctest --output-on-failure)
  plugin="$folder/build/plugins/$name.so"
  "$lockstep" list --plugin "$plugin" | grep -E "^ +$name .* $name\$"
  "$lockstep" describe "$name" --plugin "$plugin" | grep -F "$name" >/dev/null
  "$lockstep" schema --plugin "$plugin" | grep -F "\"$name\"" >/dev/null
  (cd "$folder" && LOCKSTEP_PLUGIN_PATH="$folder/build/plugins" "$lockstep" run scene.json --quiet --record "$place/$name.csv")
  test -s "$place/$name.csv"
  cmake --install "$folder/build" --prefix "$place/elsewhere" >/dev/null
  find "$place/elsewhere" -path "*/lockstep/plugins/$name.so" | grep . >/dev/null
done
rm -rf "$place"
