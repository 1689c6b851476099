// SPDX-License-Identifier: BSD-3-Clause
// Defects that are known and not mended yet, as tests.
//
// Catch has a tag for cases that fail, but under it a test passes on any failure: a scene that is no longer read, a run
// that ends at its start or a column of another name would hide as well behind it as the defect does. So such a test is
// an ordinary one, with three outcomes that it measures: the defect as it was seen (the test passes), mended, or neither
// (it fails). What holds around the defect today stands before it as plain checks.
//
// Whoever mends a defect sees its test fail with the words "is mended". The test is then made an ordinary one: the words
// `right` become a CHECK, those of `seen` go, as the tag [defect] does, and the case moves to its neighbours.
#pragma once

#include <string>

#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace lockstep::testing {

/// The path of a scene of tests/verification/defects by its name.
inline std::string defect_scene(const std::string& name) {
  return std::string(paths::kSource) + "/tests/verification/defects/" + name + ".json";
}

/// `issue` mends the defect. `seen`: it shows as it did when this was written; `right`: what is measured is right.
inline void expect_defect(const std::string& name, const std::string& issue, bool seen, bool right) {
  INFO("defect '" << name << "', which the issue '" << issue << "' mends");
  if (right)
    FAIL_CHECK("defect '" << name << "' is mended: make this an ordinary test (issue: " << issue << ")");
  else if (!seen)
    FAIL_CHECK("defect '" << name << "' shows otherwise than it was seen, and is not mended (issue: " << issue << ")");
  CHECK(seen);
}

}  // namespace lockstep::testing
