// SPDX-License-Identifier: BSD-3-Clause
// check_lock of joints that are made of a function: hidden derivatives, branches, gradients, memory.
#include <lockstep/author/check.h>

#include <lockstep/author/phi_links.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include "tests/support/catch.h"
#include "tests/support/check_words.h"

namespace check_function_test {

using namespace lockstep;
using lockstep::test::says;

namespace {

struct TurnsForgotten {
  static constexpr PhiSpec spec{.counts_turns = false};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.02 * y.angle_z();
  }
};
struct TurnsCounted {
  static constexpr PhiSpec spec{.counts_turns = true};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.02 * y.angle_z();
  }
};
struct OddInE {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.3 * y.e3;
  }
};
template <class Phi>
struct Joint final : PhiLock<Phi> {
  Joint(std::string name, Marker& p, Marker& s) : PhiLock<Phi>(std::move(name), p, s, Mask::x | Mask::y, Phi{}) {}
  std::string_view type() const override { return "joint"; }
};
template <class Phi>
CheckReport joint() {
  System system;
  const MassProperties mass{1.0, Vec3::Zero(), Vec3(0.3, 0.4, 0.5).asDiagonal()};
  Body &nut = system.add_body("nut", mass), &shaft = system.add_body("shaft", mass);
  return check_lock(system, system.add<Joint<Phi>>("thread", nut, shaft, pose_at({0, 0.1, 0})), {.seed = 4});
}

}  // namespace

TEST_CASE("check_lock follows a joint over full revolutions", "[unit][check]") {
  const CheckReport counted = joint<TurnsCounted>(), forgotten = joint<TurnsForgotten>(), odd = joint<OddInE>();
  CAPTURE(counted.text(), forgotten.text(), odd.text());
  CHECK(counted.ok());
  CHECK(says(forgotten, "constraint phi jumps at x = "));
  CHECK(says(forgotten, " by 0.126; look at the branches of the function"));
  CHECK(says(forgotten, ".counts_turns = true"));
  CHECK(says(odd, "constraint phi on body 'nut' changes with the sign of the quaternion of body 'nut'"));
}

namespace {

struct Hidden {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.3 * y.x * value_of(y.x);
  }
};
struct Branch {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.x < 0 ? y.z - 0.1 : y.z;
  }
};
struct Corner {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z + 0.5 * abs(y.x);
  }
};
struct Steps {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.x < 0 ? y.z - 0.1 - 0.4 * y.y : y.z;
  }
};
struct Scaled {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return (y.x < 0 ? 2.0 : 1.0) * (y.z - 0.2 * y.y);
  }
};
struct Flat {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 0.0 * y.z;
  }
};
/// Its gradient vanishes at its solutions.
struct Squared {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z * y.z;
  }
};

struct SameAsMask {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 2.0 * y.y;
  }
};
struct Throws {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    if (y.t > 0.5) throw std::runtime_error("the table is empty");
    return y.z;
  }
};
template <class Phi>
CheckReport typed() {
  Registry registry = builtin_registry();
  registry.links.add({"thread", "a joint", {}}, [](const Attachment& attachment, const Params&) {
    return std::make_unique<Joint<Phi>>(attachment.name, attachment.p(), attachment.s());
  });
  return check_lock(registry, "thread");
}

}  // namespace

TEST_CASE("check_lock names the variable that a function hides, and not what follows from it", "[unit][check]") {
  const CheckReport hidden = typed<Hidden>();
  CAPTURE(hidden.text());
  CHECK(hidden.findings().size() == 1);
  CHECK(says(hidden, "  the derivative of constraint phi in x is "));
  CHECK(says(hidden, "look at x: value_of() or a plain `double` hides it from the derivatives"));
  CHECK(says(hidden, "note: Jacobian, Ct, Qhat and tangent follow from the function, and were not compared"));
}

TEST_CASE("check_lock finds a branch of a function that reads no angle", "[unit][check]") {
  const CheckReport report = typed<Branch>();
  CAPTURE(report.text());
  CHECK(says(report, "C of constraint phi jumps at x = 0 m, y = "));
  CHECK(says(report, "look at the branches of the function"));
}

TEST_CASE("check_lock finds a jump or a corner of a function that is on the constraint", "[unit][check]") {
  const CheckReport corner = typed<Corner>(), steps = typed<Steps>(), scaled = typed<Scaled>();
  CAPTURE(corner.text(), steps.text(), scaled.text());
  CHECK(corner.findings().size() == 1);
  CHECK(says(corner, "  C of constraint phi has a corner at x = 0 m, y = "));
  CHECK(steps.findings().size() == 1);
  CHECK(says(steps, "which must meet with equal value, slope and curvature"));
  CHECK(scaled.ok());  // both branches are zero at the same places
  REQUIRE(scaled.notes().size() == 1);
  CHECK(scaled.notes()[0].starts_with("not tested: whether the equation is the intended one"));
}

namespace {

/// Branches at x = 0.05 m of a joint whose markers coincide at the start.
enum class At { jump, corner, scaled };
template <At at>
struct Beside {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    if (value_of(y.x) <= 0.05) return y.z + 0.0 * y.x;
    return at == At::jump ? y.z - 0.03 : at == At::corner ? y.z - 0.5 * (y.x - 0.05) : 2.0 * y.z;
  }
};
template <At at>
CheckReport beside(Mask mask, int states) {
  struct Rail final : PhiLock<Beside<at>> {
    Rail(std::string name, Marker& p, Marker& s, Mask held) : PhiLock<Beside<at>>(std::move(name), p, s, held, {}) {}
    std::string_view type() const override { return "rail"; }
  };
  System system;
  const MassProperties mass{1.0, Vec3::Zero(), Vec3(0.3, 0.4, 0.5).asDiagonal()};
  Body &bead = system.add_body("bead", mass, {Vec3(1, 0, 0), Quat{}}), &frame = system.add_body("frame", mass);
  Marker &p = system.add_marker("p", bead, pose_at({-1, 0, 0})), &s = system.add_marker("s", frame);
  return check_lock(system, system.add<Rail>("rail", p, s, mask), {.states = states});
}

}  // namespace

TEST_CASE("check_lock finds a jump and a corner on the constraint between its states", "[unit][check]") {
  for (const Mask mask : {Mask::none, Mask::y})
    for (const int states : {16, 64}) {
      const CheckReport jump = beside<At::jump>(mask, states), corner = beside<At::corner>(mask, states),
                        scaled = beside<At::scaled>(mask, states);
      CAPTURE(jump.text(), corner.text(), scaled.text());
      CHECK(jump.findings().size() == 1);
      CHECK(says(jump, "  C of constraint phi jumps at x = 0.05 m, y = "));
      CHECK(says(jump, " by 0.03 (seed 1, state "));
      CHECK(corner.findings().size() == 1);
      CHECK(says(corner, "  C of constraint phi has a corner at x = 0.05 m, y = "));
      CHECK(says(corner, "look at the branches of the function"));
      CHECK(scaled.ok());
    }
  CHECK(beside<At::jump>(Mask::x, 16).ok());  // x = 0 is held: the joint never comes to the branch
}

TEST_CASE("check_lock finds a function that removes no degree of freedom", "[unit][check]") {
  const CheckReport flat = typed<Flat>(), same = typed<SameAsMask>(), right = typed<TurnsCounted>();
  CAPTURE(flat.text(), same.text(), right.text());
  CHECK_FALSE(flat.ok());
  CHECK(says(flat, "  constraint phi removes no degree of freedom in any state; look at its equation"));
  CHECK(says(same, "  constraint phi removes no degree of freedom in any state"));
  CHECK(right.notes().size() == 1);
}

TEST_CASE("check_lock finds a function without a gradient at its solutions", "[unit][check]") {
  const CheckReport report = typed<Squared>();
  CAPTURE(report.text());
  CHECK(report.findings().size() == 1);
  CHECK(says(report, "  constraint phi has no gradient at its solutions (seed 1, state 0)"));
}

TEST_CASE("check_lock names the joint whose function throws", "[unit][check]") {
  const CheckReport report = typed<Throws>();
  CAPTURE(report.text());
  CHECK(report.findings().size() == 1);
  CHECK(says(report, "joint 'sample' (joint) threw: the table is empty"));
}

namespace {

/// Each accepted step adds to its memory once more.
struct Adding : PhiHooks {
  static constexpr PhiSpec spec{.memory = 1};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.02 * y.memory[0];
  }
  void reset(std::span<double> z, PhiCoords) const override { z[0] = 0; }
  void accept_step(std::span<double> z, PhiCoords) const override { z[0] += 0.3; }
};
struct AddsUp final : PhiLock<Adding> {
  AddsUp(std::string name, Marker& p, Marker& s) : PhiLock(std::move(name), p, s, Mask::x | Mask::y, Adding{}) {}
  std::string_view type() const override { return "adds_up"; }
};

}  // namespace

TEST_CASE("check_lock names a memory that adds up", "[unit][check]") {
  System system;
  const MassProperties mass{1.0, Vec3::Zero(), Vec3(0.3, 0.4, 0.5).asDiagonal()};
  Body &nut = system.add_body("nut", mass), &shaft = system.add_body("shaft", mass);
  const CheckReport r = check_lock(system, system.add<AddsUp>("thread", nut, shaft, pose_at({0, 0.1, 0})));
  CAPTURE(r.text());
  CHECK(says(r, "adds the same each time"));
}

}  // namespace check_function_test
