#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# headers.sh BUILD_TREE COMPILER STEP: the installed headers, in install_test/prefix, are what the umbrella says and
# compile without a warning: all of them in one file, and alone every STEP-th of them (1: each).
set -uo pipefail
build="$1" compiler="$2" step="$3"
include="$build/install_test/prefix/include"
place="$build/install_test/headers_$(basename "$compiler")_$step"
if ! command -v "$compiler" >/dev/null; then
  echo "skipped: there is no $compiler"
  exit 77
fi
mkdir -p "$place"
failed=0
others="$(pkg-config --cflags eigen3 spdlog 2>/dev/null || echo "-I/usr/include/eigen3 -DSPDLOG_FMT_EXTERNAL")"
words=(-std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Wconversion -Werror -DEIGEN_MAX_ALIGN_BYTES=16
       -DEIGEN_MALLOC_ALREADY_ALIGNED=0 -I "$include" ${others//-I/-isystem })

compiles() {  # compiles FILE WHAT
  if ! "$compiler" "${words[@]}" "$1" >"$place/words.txt" 2>&1; then
    echo "$2 does not compile by $compiler:"
    head -n 20 "$place/words.txt"
    failed=1
  fi
}

mapfile -t headers < <(cd "$include" && find lockstep -name '*.h' | sort)
strange="$(cd "$include" && find . -type f -not -path './lockstep/*.h')"
if [ -n "$strange" ]; then printf 'installed beside the public headers:\n%s\n' "$strange"; failed=1; fi
if [ "${#headers[@]}" -gt 73 ]; then echo "${#headers[@]} headers are installed; about seventy are meant to be"; failed=1; fi
for header in "${headers[@]}"; do
  case "$header" in  # those of few users, and dear: named by who needs them
    lockstep/lockstep.h | lockstep/c.h | lockstep/author/* | lockstep/detail/*) continue ;;
    lockstep/dynamics.h | lockstep/integrators.h | lockstep/linearization.h | lockstep/modes.h) continue ;;
  esac
  grep -qxF "#include <$header>" "$include/lockstep/lockstep.h" ||
    { echo "lockstep/lockstep.h does not include <$header>"; failed=1; }
done

printf '#include <%s>\n' "${headers[@]}" >"$place/all.cpp"
compiles "$place/all.cpp" "every header together"
for ((i = 0; i < ${#headers[@]}; i += step)); do
  printf '#include <%s>\n' "${headers[i]}" >"$place/one.cpp"
  compiles "$place/one.cpp" "<${headers[i]}> alone"
done
rm -rf "$place"
exit "$failed"
