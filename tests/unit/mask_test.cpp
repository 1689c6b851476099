// SPDX-License-Identifier: BSD-3-Clause
// Masks and axes in words, both ways, and what is no word.
#include <lockstep/detail/kernel.h>

#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace mask_test {

using lockstep::testing::message_of, lockstep::testing::says;

using namespace lockstep;

TEST_CASE("every mask is its words", "[unit][lock]") {
  for (unsigned m = 0; m < 64; ++m) {
    const Mask mask = Mask(std::uint8_t(m));
    CAPTURE(m);
    CHECK(mask_from(to_string(mask)) == mask);
    int n = 0;
    for (int k = 0; k < 6; ++k) n += static_cast<int>(m >> k & 1u);
    CHECK(count_rows(mask) == n);
  }
  CHECK(to_string(Mask::xyz | Mask::e1 | Mask::e2) == "x y z e1 e2");
  CHECK(mask_from("") == Mask::none);
  CHECK(mask_from("  e2,x |z\t") == (Mask::x | Mask::z | Mask::e2));
  CHECK(includes(Mask::all, Mask::xyz | Mask::e123));
  CHECK_FALSE(includes(Mask::xyz, Mask::x | Mask::e1));
  CHECK(overlaps(Mask::xyz, Mask::x | Mask::e1));
  CHECK_FALSE(overlaps(Mask::xyz, Mask::e123));
}

TEST_CASE("axes are words, and drive the constraint of their place", "[unit][lock]") {
  const char* words[] = {"x", "y", "z", "rx", "ry", "rz"};
  const char* rows[] = {"x", "y", "z", "e1", "e2", "e3"};
  for (int k = 0; k < 6; ++k) {
    const Axis axis = axis_from(words[k]);
    CHECK(axis_index(axis) == k);
    CHECK(to_string(axis) == words[k]);
    CHECK(is_rotation(axis) == (k >= 3));
    CHECK(to_string(row_of(axis)) == rows[k]);
    CHECK(row_name(k) == rows[k]);
  }
}

TEST_CASE("unknown words are rejected with the known ones", "[unit][lock]") {
  CHECK(says(message_of<ModelError>([] { mask_from("x y w"); }), {"\"w\"", "x, y, z, e1, e2 and e3"}));
  CHECK(says(message_of<ModelError>([] { mask_from("x e0"); }), {"\"e0\"", "e1"}));
  CHECK(says(message_of<ModelError>([] { mask_from("x y x"); }), {"\"x\"", "twice", "once"}));
  CHECK(says(message_of<ModelError>([] { axis_from("e1"); }), {"\"e1\"", "x, y, z, rx, ry and rz"}));
  CHECK(says(message_of<ModelError>([] { axis_from(""); }), {"\"\"", "rz"}));
}

}  // namespace mask_test
