#pragma once
#include "framework/foundation/support/text.h"
