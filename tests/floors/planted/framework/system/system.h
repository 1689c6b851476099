#pragma once
#include "framework/links/joints.h"
