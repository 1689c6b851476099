#include "framework/mechanism/links/joints.h"
