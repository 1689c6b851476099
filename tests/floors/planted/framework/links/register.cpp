#include "framework/builtins.h"
#include "framework/links/joints.h"
