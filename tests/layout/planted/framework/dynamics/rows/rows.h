#pragma once
#include "framework/mechanism/model/body.h"
