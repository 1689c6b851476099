#!/usr/bin/env bash
# exports.sh LIBRARY...: shows every symbol that a library offers beyond namespace lockstep and the record of plugins.
# 77: no nm here.
set -euo pipefail
if ! command -v nm >/dev/null; then
  echo "skipped: there is no nm"
  exit 77
fi
kinds='(vtable|VTT|typeinfo|typeinfo name|guard variable|construction vtable) for |(non-virtual|virtual|covariant return) thunk to '
for library in "$@"; do
  offered="$(nm -DC --defined-only "$library" | cut -d ' ' -f 3-)"
  strange="$(printf '%s\n' "$offered" | grep -v -E "^($kinds)?lockstep::|^void lockstep::built_with::|^lockstep_" || true)"
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
