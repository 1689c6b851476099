#pragma once
#include "framework/mechanism/links/joints.h"
