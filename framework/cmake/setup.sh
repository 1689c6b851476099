# SPDX-License-Identifier: BSD-3-Clause
# Sourced by samples/run and tests/run: finds what is missing, installs it by apt-get, configures and builds the release
# preset, or the one that LOCKSTEP_PRESET names. What is up to date is not touched, and nothing is asked of the network when nothing is missing.
#
# Settings from outside: LOCKSTEP_PRETEND_MISSING="catch2 ..." treats these Debian packages as absent (to try this file).
# Exit code 69: something is missing and could not be installed from here.

preset="${LOCKSTEP_PRESET:-release}"
build="$root/build/$preset"

say() { printf 'lockstep: %s\n' "$*" >&2; }

has_command() { command -v "$1" >/dev/null 2>&1; }

# has_header eigen3/Eigen/Core: looks where compilers look, without starting one.
has_header() {
  local folder
  local IFS=':;'
  for folder in /usr/include /usr/local/include ${CPATH:-} ${CPLUS_INCLUDE_PATH:-}; do
    if [ -e "$folder/$1" ]; then return 0; fi
  done
  for folder in ${CMAKE_PREFIX_PATH:-}; do
    if [ -e "$folder/include/$1" ]; then return 0; fi
  done
  return 1
}

# need PACKAGE CHECK...: the package counts as missing when every check fails. A check with a slash is a header.
need() {
  local package="$1" check
  shift
  case " ${LOCKSTEP_PRETEND_MISSING:-} " in
    *" $package "*) ;;
    *)
      for check in "$@"; do
        case "$check" in
          */*) if has_header "$check"; then return 0; fi ;;
          *) if has_command "$check"; then return 0; fi ;;
        esac
      done
      ;;
  esac
  missing+=("$package")
}

find_missing() {
  missing=()
  need g++ c++ g++ clang++
  need cmake cmake
  need ninja-build ninja
  need libeigen3-dev eigen3/Eigen/Core Eigen/Core
  need libboost-dev boost/dll/shared_library.hpp
  need libspdlog-dev spdlog/spdlog.h
  need nlohmann-json3-dev nlohmann/json.hpp
  need libcli11-dev CLI/CLI.hpp
  need catch2 catch2/catch.hpp catch2/catch_all.hpp
  need gnuplot-nox gnuplot
  need libnlopt-dev ./nlopt.h
  case "$preset" in
    asan | clang | tsan) need clang clang++ ;;
    tidy) need clang clang++; need clang-tidy clang-tidy ;;
  esac
}

install_missing() {
  local command="apt-get install --yes --no-install-recommends ${missing[*]}"
  local -a as_root=()
  if ! has_command apt-get; then
    say "missing: ${missing[*]} (Debian's names), and there is no apt-get here;" \
      "install them with the package manager of this system."
    exit 69
  fi
  if [ "$(id -u)" -ne 0 ]; then
    if has_command sudo && sudo -n true 2>/dev/null; then
      as_root=(sudo -n)
    else
      say "missing: ${missing[*]}; please type: sudo $command"
      exit 69
    fi
  fi
  say "missing: ${missing[*]}; installing by ${as_root[*]:+sudo }apt-get"
  "${as_root[@]}" apt-get update >&2 || say "apt-get update failed; trying with the package lists that are here"
  if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive $command >&2; then
    say "apt-get could not install ${missing[*]}; mend what it says above, then type: ${as_root[*]:+sudo }$command"
    exit 69
  fi
}

# wish PACKAGE COMMAND WHAT_FOR: as need, for what a few tests use; where it cannot be installed, all goes on without it.
wish() {
  missing=()
  need "$1" "$2"
  if [ "${#missing[@]}" -eq 0 ]; then return 0; fi
  if (install_missing); then rm -f "$build/configured"; else say "going on without $1: $3"; fi
}

# The first version of the two is the lower one or the same.
version_reached() { [ "$(printf '%s\n%s\n' "$1" "$2" | sort -V | head -n 1)" = "$1" ]; }

set_up() {
  find_missing
  if [ "${#missing[@]}" -gt 0 ]; then install_missing; fi
  if [ -e "$build/build.ninja" ]; then return 0; fi
  local found
  found="$(cmake --version | sed -n '1s/[^0-9]*//p')"
  if ! version_reached 3.25 "$found"; then
    say "cmake 3.25 or newer is needed, this one is $found; Debian 12 and newer bring one."
    exit 69
  fi
}

cached() { grep -q "^$1\$" "$build/CMakeCache.txt" 2>/dev/null; }

# configure: only when there is no build tree yet, or one that was made for another place, by older presets, or without
# tests and samples.
configure() {
  local -a fresh=()
  if [ -e "$build/CMakeCache.txt" ] && ! cached "CMAKE_HOME_DIRECTORY:INTERNAL=$root"; then fresh=(--fresh); fi
  if [ -e "$build/build.ninja" ] && [ "${#fresh[@]}" -eq 0 ] && [ ! "$root/CMakePresets.json" -nt "$build/configured" ] &&
    cached "LOCKSTEP_BUILD_TESTS:BOOL=ON" && cached "LOCKSTEP_BUILD_SAMPLES:BOOL=ON"; then
    return 0
  fi
  say "configuring build/$preset"
  mkdir -p "$build"
  if ! (cd "$root" && cmake "${fresh[@]}" --preset "$preset" -DLOCKSTEP_BUILD_TESTS=ON -DLOCKSTEP_BUILD_SAMPLES=ON) \
    >"$build/configure.log" 2>&1 || ! touch "$build/configured"; then
    cat "$build/configure.log" >&2
    say "the configuration failed; what cmake said is above and in build/$preset/configure.log"
    exit 1
  fi
}

# build TARGET...: quiet when there is nothing to do.
build() {
  local jobs
  jobs="$(nproc 2>/dev/null || echo 2)"
  configure
  if ! cmake --build "$build" --parallel "$jobs" --target "$@" |
    { grep --line-buffered -v -e 'ninja: no work to do' -e 'Re-checking globbed' -e 'Reading the commit' -e 'Writing schema, manual' || true; } >&2; then
    say "the build failed; the compiler's words are above"
    exit 1
  fi
}
