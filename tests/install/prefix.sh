#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# prefix.sh BUILD_TREE: installs it once to BUILD_TREE/install_test/prefix, for all tests that use the installed package
# (ctest fixture `installed`). Each of them works in a folder of its own beside it, and leaves the prefix as it is.
set -euo pipefail
build="$1"
rm -rf "$build/install_test"
cmake --install "$build" --prefix "$build/install_test/prefix" >/dev/null
