#include "framework/description/registry/builtins.h"
#include "framework/mechanism/links/joints.h"
