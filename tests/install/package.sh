#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# package.sh BUILD_TREE CPACK: makes the Debian packages from the build tree, unpacks them by dpkg into a root of their
# own, runs a scene with the program from there, removes them again, and looks for what they left. 77: no dpkg here.
set -euo pipefail
unset LOCKSTEP_PLUGIN_PATH
build="$1" cpack="$2"
place="$build/install_test_packages"
root="$place/root"
for tool in dpkg dpkg-deb; do
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: there is no $tool"
    exit 77
  fi
done
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v fakeroot >/dev/null; then
    echo "skipped: dpkg installs as root only, and there is no fakeroot"
    exit 77
  fi
  as_root=(fakeroot)
fi
rm -rf "$place"
mkdir -p "$place/made" "$place/bin" "$root/var/lib/dpkg/updates" "$root/var/lib/dpkg/info"
touch "$root/var/lib/dpkg/status"

(cd "$place" && "$cpack" -G DEB --config "$build/CPackConfig.cmake" -B "$place/made" >"$place/cpack.txt" 2>&1) || {
  cat "$place/cpack.txt"
  exit 1
}
rm -rf "$place/made/_CPack_Packages"
field() { dpkg-deb --field "$1" "$2"; }
files=("$place"/made/*.deb)
names=()
for file in "${files[@]}"; do
  names+=("$(field "$file" Package)")
  case "${names[-1]}" in
    *-doc) ;;
    liblockstep[0-9]*) test -n "$(field "$file" Depends)" ;;
    *) # what uses the insides of the library needs the one that it was built with
      field "$file" Depends | grep -E "liblockstep[0-9]+ \(= $(field "$file" Version)\)" >/dev/null ||
        { echo "${names[-1]} does not depend on its own version of the library" && exit 1; } ;;
  esac
  field "$file" Description | sed -n 2p | grep '^ ' >/dev/null
done
echo "made: ${names[*]}"
case " ${names[*]} " in *" liblockstep-dev "*) ;; *) exit 1 ;; esac

# The packages' scripts run here, not in that root, where there is no shell; the ldconfig that they call is this one.
printf '#!/bin/sh\necho "$DPKG_ROOT" >>"%s"\n' "$place/ldconfig.txt" >"$place/bin/ldconfig"
chmod +x "$place/bin/ldconfig"
throw_away() {
  PATH="$place/bin:$PATH" "${as_root[@]}" dpkg --root="$root" --log="$place/dpkg.log" --force-not-root --force-depends \
    --force-script-chrootless "$@"
}
(cd "$root" && find . -not -type d -not -path './var/*' | sort) >"$place/before.txt"
throw_away --install "${files[@]}" >"$place/dpkg.txt" 2>&1 || {
  cat "$place/dpkg.txt"
  exit 1
}

program="$root/usr/bin/lockstep"
env -u LD_LIBRARY_PATH ldd "$program" | grep "liblockstep.* => $root/" >/dev/null ||
  { echo "the program does not find the library beside it" && exit 1; }
env -u LD_LIBRARY_PATH "$program" check "$root/usr/share/lockstep/scenes/four_bar.json" | grep -E 'degrees of freedom +1, driven by A' >/dev/null ||
  { echo "the program does not call those in libexec" && exit 1; }
env -u LD_LIBRARY_PATH "$program" run "$root/usr/share/lockstep/scenes/four_bar.json" --quiet \
  --record "$place/four_bar.csv"
test "$(wc -l <"$place/four_bar.csv")" -gt 10
# A library with the checks of a sanitizer cannot be loaded by a python3 without them.
if [ -d "$root/usr/lib/python3" ] && ! grep -q -e -fsanitize "$build/CMakeCache.txt"; then
  env -u LD_LIBRARY_PATH PYTHONPATH="$root/usr/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c "
import lockstep as ls
table = ls.Simulation('$root/usr/share/lockstep/scenes/four_bar.json', crank='0.12 m').run()
assert len(table) == 71 and abs(table['theta'][-1] - table['theta'][0] - 7) < 1e-8"
  test -s "$root/usr/share/doc/lockstep/samples/hosts/python/controller.py"
fi
"$program" describe bump --plugin bump | grep bump >/dev/null  # from the installed folder
for kept in usr/share/doc/lockstep/plugins/README.md usr/share/doc/lockstep/samples/host_app/main.cpp usr/include/lockstep/lockstep.h usr/lib/pkgconfig/lockstep.pc \
  usr/include/lockstep/c.h usr/lib/pkgconfig/lockstep-c.pc usr/share/doc/lockstep/samples/hosts/c/pendulum.c \
  usr/share/doc/lockstep/samples/scenes/pendulum.json; do test -s "$root/$kept"; done

for name in "${names[@]}"; do for file in copyright changelog.gz; do test -s "$root/usr/share/doc/$name/$file"; done; done
gzip -cd "$root/usr/share/man/man1/lockstep.1.gz" | grep -F '.SS "lockstep demo' >/dev/null
bash -n "$root/usr/share/bash-completion/completions/lockstep"
if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error "${files[@]}" >"$place/lintian.txt" 2>&1 || { cat "$place/lintian.txt" && exit 1; }
fi

throw_away --purge "${names[@]}" >"$place/dpkg.txt" 2>&1 || {
  cat "$place/dpkg.txt"
  exit 1
}
grep -q -v -F -x "$root" "$place/ldconfig.txt" && exit 1
test "$(wc -l <"$place/ldconfig.txt")" -ge 2  # when it came and when it went
(cd "$root" && find . -not -type d -not -path './var/*' | sort) >"$place/after.txt"
diff "$place/before.txt" "$place/after.txt" || { echo "these files were left behind" && exit 1; }
left="$(find "$root/usr" 2>/dev/null || true)"
if [ -n "$left" ]; then printf 'these folders were left behind:\n%s\n' "$left"; exit 1; fi
rm -rf "$place"
