#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# run.sh COMPILER FLAGS...: no function of functions.cpp behind "refused:" may compile, and the compiler must say what
# stands there. What stands before the first of them must compile.
set -uo pipefail
source="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/functions.cpp"
export LC_ALL=C
head="$(sed '/^\/\/ refused: /,$d' "$source")"
compile() { printf '%s\n%s\n}\n' "$head" "$1" | "${compiler[@]}" -std=c++20 -fsyntax-only -x c++ - 2>&1; }
compiler=("$@")
compile "" || { echo "what is right does not compile"; exit 1; }
wrong=0 cases=0
while IFS= read -r line; do
  cases=$((cases + 1))
  case="$(awk -v line="// refused: $line" '$0 == line {on = 1; next} /^(\/\/ refused: |}  \/\/ namespace)/ {on = 0} on' "$source")"
  words="$(compile "$case")" && { echo "compiles: $line"; wrong=1; }
  grep -qF -- "$line" <<<"$words" || { echo "not said: $line"; wrong=1; }
done < <(sed -n 's|^// refused: ||p' "$source")
[ "$wrong" -eq 0 ] && [ "$cases" -ge 12 ] && echo "$cases functions are refused in words"
