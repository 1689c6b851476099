// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"

namespace force_register_test {

using namespace lockstep;
using oracle::ForceBench;

namespace {
// Every constant law is the constant 2.
void add_twos(Registry& registry) {
  registry.laws.add({"constant", "", {{"value", Form::number, Unit::any, kRequired, ""}}},
                    [](const Params&) -> LawPtr<MotionLaw> { return oracle::value_law([](double) { return 2.0; }); });
}

struct Shop {
  Registry registry;
  ForceBench bench{7};
  Shop() {
    register_forces(registry);
    add_twos(registry);
  }
  std::unique_ptr<Force> make(const std::string& type, const Params& params, bool with_s = true) {
    const Attachment attachment{"F", {{&bench.p, with_s ? &bench.s : nullptr}}};
    auto force = registry.forces.make(type, attachment, params, &registry, "force 'F'");
    force->setup();
    return force;
  }
  double quantity(const Force& force, const std::string& name) {
    return force.observable()->quantity(oracle::quantity_index(force, name), bench.in());
  }
};
}  // namespace

TEST_CASE("register_forces: every force by its name, each with help for each key", "[unit][force]") {
  Shop shop;
  const std::vector<std::string> names{"applied_force", "applied_torque", "bushing",
                                       "force_motor",   "function_force", "joint_friction",
                                       "spring_damper", "torque_motor",   "torsion_spring_damper"};
  CHECK(shop.registry.forces.names() == names);
  for (const auto& [name, entry] : shop.registry.forces.entries()) {
    CHECK(entry.info.name == name);
    CHECK_FALSE(entry.info.help.empty());
    for (const Key& key : entry.info.keys) CHECK_FALSE(key.help.empty());
  }
}

TEST_CASE("register_forces: keys reach what they name", "[unit][force]") {
  Shop shop;
  const auto spring =
      shop.make("spring_damper", {{"stiffness", "2 N/mm"}, {"free_length", 0.1}, {"preload", 5}, {"force", 1}});
  const double l = shop.quantity(*spring, "length");
  CHECK(shop.quantity(*spring, "force") == Approx(2000 * (l - 0.1) + 5 + 2));
  CHECK(spring->type() == "spring_damper");
  const auto torsion = shop.make("torsion_spring_damper", {{"stiffness", 3}, {"free_angle", "90 deg"}, {"torque", 1}});
  CHECK(shop.quantity(*torsion, "torque") == Approx(3 * (shop.quantity(*torsion, "angle") - kPi / 2) + 2));
  CHECK(shop.quantity(*shop.make("torque_motor", {{"torque", 1}}), "torque") == 2);
  CHECK(shop.quantity(*shop.make("force_motor", {{"force", 1}}), "force") == 2);
  const auto bushing = shop.make("bushing", {{"stiffness", Value::list({1, 2, 3})}});
  CHECK(shop.quantity(*bushing, "force_on_p_link_z") == Approx(-3 * shop.quantity(*bushing, "z")));
  const auto push =
      shop.make("applied_force", {{"force", Value::list({1, 0, 0})}, {"law", 1}, {"direction", "-y"}}, false);
  CHECK((shop.bench.force_on(*push, 0) - Vec3(1, -2, 0)).norm() < 1e-14);
  CHECK(shop.bench.force_on(*push, 1).norm() == 0);
  const auto twist = shop.make("applied_torque", {{"torque", Value::list({1, 2, 3})}, {"axes", "marker"}});
  CHECK((shop.bench.moment_on(*twist, 1) + in_world(MarkerFrame(shop.bench.p), shop.bench.in()).A * Vec3(1, 2, 3))
            .norm() < 1e-13);
}

TEST_CASE("register_forces: wrong keys are rejected at their place", "[unit][force]") {
  Shop shop;
  const auto refusal = [&](const std::string& type, const Params& params, bool with_s = true) -> std::string {
    try {
      shop.make(type, params, with_s);
    } catch (const SceneError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(refusal("spring_damper", {{"damping", -1}}).find("force 'F', damping: is -1") != std::string::npos);
  CHECK(refusal("spring_damper", {{"stifness", 1}}).find("stiffness") != std::string::npos);
  CHECK(refusal("spring_damper", {{"stiffness", 1}}, false).find("force 'F', s: missing") != std::string::npos);
  CHECK(refusal("applied_force", {}).find("nothing to apply") != std::string::npos);
  CHECK(refusal("applied_force", {{"law", 1}}).find("direction") != std::string::npos);
  CHECK(refusal("applied_force", {{"direction", "x"}, {"force", Value::list({1, 0, 0})}}).find("without \"law\"") !=
        std::string::npos);
  CHECK(refusal("applied_torque", {{"laws", Value(Value::List{1.0, 2.0})}}).find("has 2 laws") != std::string::npos);
  CHECK(refusal("torque_motor", {}).find("torque") != std::string::npos);
  CHECK(refusal("bushing", {{"damping", Value::list({0, -1, 0})}}).find("damping: is -1") != std::string::npos);
}

}  // namespace force_register_test
