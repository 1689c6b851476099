#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# run.sh COMPILER FLAGS...: functions.cpp must not compile, and the compiler must say all that stands behind "refused:",
# each beside the name of the function below it.
set -uo pipefail
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
source="$here/functions.cpp"
all=-fmax-errors=0
"$1" --version | grep -q clang && all=-ferror-limit=0
words="$("$@" $all -std=c++20 -fsyntax-only -fno-diagnostics-color "$source" 2>&1)" && { echo "$source compiles"; exit 1; }
missing=0 cases=0
while IFS= read -r line; do
  cases=$((cases + 1))
  grep -qF -- "$line" <<<"$words" || { echo "not said: $line"; missing=1; }
done < <(sed -n 's|^// refused: ||p' "$source")
while IFS= read -r name; do
  grep -qE "(\b|::)$name\b" <<<"$words" || { echo "not named: $name"; missing=1; }
done < <(sed -n 's|^template class Phi[A-Za-z]*<\(.*\)>;|\1|p' "$source")
grep -E "error:.*\bRight\b" <<<"$words" && { echo "Right is refused"; missing=1; }
[ "$missing" -eq 0 ] && [ "$cases" -ge 25 ] && echo "$cases functions are refused in words"
