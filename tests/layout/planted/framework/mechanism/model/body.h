// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "framework/dynamics/rows/rows.h"
#include "framework/foundation/support/text.h"
