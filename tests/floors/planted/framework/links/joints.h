#pragma once
#include "framework/lock/lock.h"
#include "framework/system/system.h"
#include "motionlaws/ramp.h"
