#pragma once
#include "framework/kkt/rows.h"
#include "framework/support/text.h"
