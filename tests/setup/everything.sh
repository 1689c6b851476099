#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# everything.sh EVERYTHING: tests/everything in a clone of one commit, with three checks of its own: what failed is kept
# with its output, what has a result is not run again unless asked for by name, and another commit begins anew.
set -uo pipefail
everything="$1"
command -v git >/dev/null || { echo "skipped: there is no git"; exit 77; }
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT
n_failed=0
fault() { echo "$1"; n_failed=$((n_failed + 1)); }
commit() { git -C "$place/tree" -c user.name=t -c user.email=t@example.org commit -q --allow-empty -m "$1"; }

mkdir -p "$place/tree/tests"
git -C "$place/tree" init -q
commit first
cp "$everything" "$place/tree/tests/everything"
printf 'right\tsh %s/right\nwrong\tsh %s/wrong\nlean\techo skipped: no tool\n' "$place" "$place" >"$place/checks"
echo "echo right >>$place/ran" >"$place/right"
echo "echo wrong >>$place/ran; echo why; exit 3" >"$place/wrong"
run() { LOCKSTEP_CHECKS="$place/checks" "$place/tree/tests/everything" "$@" >"$place/out" 2>&1; }
result() { awk -v name="$1" '$1 == name { for (i = 1; i < 5; ++i) sub(/^[^ ]+ +/, ""); print }' "$place/out" | tail -1; }

run && fault "a failed check leaves exit code 0"
[ "$(result right), $(result wrong), $(result lean)" = "passed, failed (3), passed, some skipped" ] ||
  fault "the table is not that of the three checks: $(cat "$place/out")"
[ "$(cat "$place/tree/build/everything/wrong.txt")" = why ] || fault "what the failed check wrote is not kept"
run && fault "a check that failed before leaves exit code 0"
[ "$(cat "$place/ran")" = $'right\nwrong' ] || fault "checks with a result ran again: $(cat "$place/ran")"
echo true >"$place/wrong"
run wrong || fault "a check that passes at last leaves an exit code: $(cat "$place/out")"
run nothing
[ $? -eq 2 ] || fault "a name that no check has is taken"
commit second
run --table || fault "the table is no success"
awk '$1 == "right"' "$place/out" | grep -q passed || fault "the last result of another commit is not shown"
run right || fault "a passed check leaves an exit code: $(cat "$place/out")"
[ "$(cat "$place/ran")" = $'right\nwrong\nright' ] || fault "of another commit the check was not run: $(cat "$place/ran")"
[ "$n_failed" -eq 0 ]
