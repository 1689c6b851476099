#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# weighed.sh: weigh finds exactly the faults planted beside this file, counts what is there, and lowers budgets.
set -uo pipefail
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT
cp -r "$here/planted" "$place/tree"
fail() { echo "$1"; exit 1; }

found="$("$here/weigh" --check "$place/tree" 2>&1)" && fail "the planted faults were not found"
diff "$here/planted/expected_weights.txt" - <<<"$found" || exit 1
# A declarator each, not the exponent of a named one; 1e9; and as other forms a scalar, a decimal and a bare comparison.
counted="$("$here/weigh" "$place/tree")"
grep -qE '^motionlaws +6 +2 +1 +3$' <<<"$counted" || fail "motionlaws is not counted as 6 lines, 2 + 1 numbers, 3 others"

# Budgets that are met pass; what falls is written, and nothing else.
sed -e '/^attic/d' -e 's/^motionlaws .*/motionlaws                         6     3     3/' \
  -e '$a mechanism/system                   2     0     0' -i "$place/tree/framework/budgets.txt"
"$here/weigh" --check "$place/tree" || fail "budgets that are met do not pass"
"$here/weigh" --lower "$place/tree" || fail "budgets are not lowered"
grep -qE '^description/registry +1 +0 +0$' "$place/tree/framework/budgets.txt" || fail "the registry's budget was not lowered"
grep -qE '^motionlaws +6 +3 +3$' "$place/tree/framework/budgets.txt" || fail "a budget that is met was changed"
"$here/weigh" --check "$place/tree" || fail "lowered budgets do not pass"
