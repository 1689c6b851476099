#pragma once
#include "framework/model/body.h"

#  include "framework/links/joints.h"
#include "kernel.h"
