#pragma once
#include "framework/model/body.h"
