#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# missing.sh BUILD_TREE: a library with LOCKSTEP_BUILTINS=OFF that does not find the plugins it lives on says so.
set -uo pipefail
place="$1/missing_test"
rm -rf "$place"
mkdir -p "$place/bin" "$place/lib"
cp "$1/bin/lockstep" "$place/bin/"
cp -a "$1"/lib/liblockstep*.so* "$place/lib/"
said="$(LD_LIBRARY_PATH="$place/lib" "$place/bin/lockstep" list laws 2>&1)" && { echo "it went well: $said" && exit 1; }
for word in motionlaws LOCKSTEP_BUILTINS=OFF 'not found' "$place" LOCKSTEP_PLUGIN_PATH; do
  case "$said" in *"$word"*) ;; *) printf 'no word of %s in: %s\n' "$word" "$said" && exit 1 ;; esac
done
cp -a "$1/plugins" "$place/plugins"
LD_LIBRARY_PATH="$place/lib" "$place/bin/lockstep" list laws | grep '^ *sine ' >/dev/null || { echo 'no law sine in the list' && exit 1; }
rm -rf "$place"
