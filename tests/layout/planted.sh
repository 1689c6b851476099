#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# planted.sh PROGRAM: the test must fail on the tree beside this file and name exactly the faults planted in it.
set -uo pipefail
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
found="$("$1" "$here/planted")"
code=$?
if [ "$code" -ne 1 ]; then
  echo "exit code $code instead of 1"
  exit 1
fi
diff "$here/planted/expected.txt" - <<<"$found"
