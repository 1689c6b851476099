#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# exports.sh LIBRARY...: shows every symbol that a library offers beyond namespace lockstep and the record of plugins, and every
# function of the installed headers that no library offers.
# 77: no nm here.
set -euo pipefail
if ! command -v nm >/dev/null; then
  echo "skipped: there is no nm"
  exit 77
fi
kinds='(vtable|VTT|typeinfo|typeinfo name|guard variable|construction vtable) for |(non-virtual|virtual|covariant return) thunk to '
for library in "$@"; do
  offered="$(nm -DC --defined-only "$library" | cut -d ' ' -f 3-)"
  strange="$(printf '%s\n' "$offered" | grep -v -E "^($kinds)?lockstep::|^void lockstep::built_with::|^lockstep_|^LOCKSTEP_C_" || true)"
  if [ -n "$strange" ]; then
    printf '%s offers what is not meant for others:\n%s\n' "$library" "$strange"
    exit 1
  fi
done
# What must stay: a client catches errors by type and casts to exported classes.
offered="$(nm -DC --defined-only "$1")"
for symbol in 'typeinfo for lockstep::SceneError' 'typeinfo for lockstep::Lock' 'vtable for lockstep::Observer' \
  'lockstep::builtin_registry()' 'lockstep::built_with::eigen_max_align_bytes<16>()'; do
  case "$offered" in *"$symbol"*) ;; *)
    echo "$1 does not offer $symbol"
    exit 1
    ;;
  esac
done
# Every function that an installed header declares can be linked. First, planted ones are found.
here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
planted='namespace lockstep {
int lost(int); LOCKSTEP_API int kept(int); inline int here() { return 1; } template <class T> T made(T);
struct Loose { int f() const { return lost(1); } int gone() const; std::function<int(int)> call; };
class LOCKSTEP_API Whole { int there(); };
}'
found="$(awk -f "$here/unexported.awk" - <<<"$planted" | sed 's/^[^:]*: *//')"
if [ "$found" != $'int lost(int)\nint gone() const' ]; then
  printf 'of the planted functions these were found:\n%s\n' "$found"
  exit 1
fi
found="$(awk -f "$here/unexported.awk" "$here"/../../framework/include/lockstep/{,author/,detail/}*.h)"
if [ -n "$found" ]; then
  printf 'declared in installed headers, and not exported:\n%s\n' "$found"
  exit 1
fi
