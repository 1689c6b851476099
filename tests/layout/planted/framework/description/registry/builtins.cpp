// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/links/joints.h"
