#pragma once
#include "framework/mechanism/lock/lock.h"
#include "framework/mechanism/system/system.h"
#include "motionlaws/ramp.h"
