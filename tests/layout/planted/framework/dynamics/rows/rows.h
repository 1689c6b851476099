// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "framework/mechanism/model/body.h"
