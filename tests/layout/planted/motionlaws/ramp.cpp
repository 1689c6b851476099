#include "tests/support/catch.h"
#include "framework/attic/old.h"
