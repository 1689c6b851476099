// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/catch.h"
#include "framework/attic/old.h"
