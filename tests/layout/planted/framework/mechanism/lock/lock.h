#pragma once
#include "framework/mechanism/model/body.h"

#  include "framework/mechanism/links/joints.h"
#include "kernel.h"
