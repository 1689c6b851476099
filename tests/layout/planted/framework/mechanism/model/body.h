#pragma once
#include "framework/dynamics/rows/rows.h"
#include "framework/foundation/support/text.h"
