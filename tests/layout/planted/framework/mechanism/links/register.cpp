// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"
#include "framework/mechanism/links/joints.h"
