#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# jets.sh COMPILER FLAGS...: functions of std on jets are one error, in at most 40 lines, which names each function of
# jet.h; what is right compiles.
set -uo pipefail
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
all=-fmax-errors=0
"$1" --version | grep -q clang && all=-ferror-limit=0
words=("$@" "$all" -std=c++20 -fsyntax-only -fno-diagnostics-color "$here/jets.cpp")
failed=0
"${words[@]}" || { echo "what is right does not compile"; failed=1; }
mapfile -t known < <(sed -nE 's/^inline (Jet<N, T, D>|jet_detail::JetOf<A, B>) ([a-z0-9]+)\(.*/\2/p' "$here/../../framework/include/lockstep/author/jet.h" |
  grep -vwE "inverse|chain" | sort -u)
[ "${#known[@]}" -ge 16 ] || { echo "jet.h is read wrongly: ${known[*]}"; failed=1; }
for place in 1 2 3; do
  said="$("${words[@]}" "-DPLACE=$place" 2>&1)"
  n="$(grep -c 'error:' <<<"$said")"
  [ "$n" -eq 1 ] || { echo "place $place: $n errors, not 1:"; grep 'error:' <<<"$said"; failed=1; }
  lines="$(wc -l <<<"$said")"
  [ "$lines" -le 40 ] || { echo "place $place: $lines lines, more than 40"; failed=1; }
  error="$(grep 'error:' <<<"$said")"
  for function in 'write sin(x), not std::sin(x)' "${known[@]}"; do
    grep -qwF -- "$function" <<<"$error" || { echo "place $place does not name $function: $error"; failed=1; }
  done
  echo "place $place: $n error in $lines lines"
done
exit "$failed"
