#include "framework/attic/old.h"
#include "tests/support/catch.h"
