// SPDX-License-Identifier: BSD-3-Clause
// Checkpoints whose hash fits and whose numbers are those of no run: refused by their cause, and the run goes on from a
// good one as if they had not been read.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace refused_checkpoints_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

/// A rod that turns on a hinge, in a run with outputs and an event.
struct Swing {
  System system{System::Options{{0, -9.81, 0}}};
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  Revolute& hinge = system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}));
  Simulation run;
  explicit Swing(const std::string& integrator, const std::string& event = "late")
      : run(system,
            {.integrator = integrator, .step = integrator == "generalized_alpha" ? 0.01 : 0.0, .output = 0.01}) {
    run.add_event({.name = event, .at = 5, .stop = true});
  }
};

Snapshot saved_at(double t, const std::string& integrator) {
  Swing swing(integrator);
  swing.run.run_until(t);
  Snapshot saved;
  swing.run.loop().save(saved);
  return saved;
}

/// What is said where one number after the other, but for those of the run's description, is another one.
std::set<std::string> causes(Swing& on, const Snapshot& saved) {
  std::set<std::string> all;
  const auto described = static_cast<std::size_t>(saved.numbers()[0]) + 1;
  for (std::size_t at = described; at < saved.numbers().size(); ++at)
    for (const double other : {saved.numbers()[at] - 1, -1.0, std::nan("")}) {
      std::vector<double> numbers = saved.numbers();
      numbers[at] = other;
      Snapshot bad;
      bad.assign(std::move(numbers));
      all.insert(message_of<Error>([&] { on.run.loop().load(bad); }));
    }
  return all;
}

}  // namespace

TEST_CASE("an impossible number of a checkpoint is rejected by its meaning", "[unit][refusals]") {
  struct Case {
    std::string integrator;
    std::vector<std::string> causes;
  };
  const auto each = GENERATE(values<Case>(
      {{"dop853",
        {"the saved state is not finite: the checkpoint is damaged",
         "the saved number of outputs is negative: the checkpoint is damaged",
         "the saved outputs do not fit the time of the saved state: the checkpoint is damaged",
         "the saved state does not fit the system", "dop853: the saved history belongs to another mechanism",
         "the run was saved with 0 events and has 1; add the same events before load()",
         "the run was saved with event 'kate' and has 'late' in its place"}},
       {"radau5", {"radau5: the saved history belongs to another mechanism"}},
       {"generalized_alpha", {"generalized_alpha: the saved history belongs to another mechanism"}}}));
  CAPTURE(each.integrator);
  const Snapshot saved = saved_at(0.123, each.integrator);
  Swing on(each.integrator), whole(each.integrator);
  const std::set<std::string> said = causes(on, saved);
  for (const std::string& cause : each.causes) {
    INFO("missing: " << cause);
    CHECK(std::any_of(said.begin(), said.end(),
                      [&](const std::string& s) { return s.find(cause) != std::string::npos; }));
  }
  on.run.loop().load(saved);
  on.run.run_until(0.3);
  whole.run.run_until(0.123), whole.run.run_until(0.3);
  CHECK(on.run.state().q == whole.run.state().q);
  CHECK(on.run.state().v == whole.run.state().v);
}

TEST_CASE("a checkpoint with an event of another name is rejected by both names", "[unit][refusals]") {
  const Snapshot saved = saved_at(0.05, "dop853");
  Swing other("dop853", "early");
  check_words(message_of<ModelError>([&] { other.run.loop().load(saved); }),
              {"saved with event 'late'", "has 'early' in its place", "in the same order"});
}

TEST_CASE("a saved state with flags of another number of joints is rejected", "[unit][refusals]") {
  Swing swing("dop853");
  Dynamics dynamics(swing.system, std::make_unique<SchurSolver>());
  for (std::vector<bool> State::*flags : {&State::modes, &State::watched}) {
    State state = swing.system.start();
    (state.*flags).push_back(false);
    Snapshot saved;
    dynamics.save_state(state, saved);
    SnapshotReader in(saved);
    check_words(message_of<ModelError>([&] { dynamics.load_state(state, in); }),
                {"the saved state does not fit the system"});
  }
}

TEST_CASE("a run whose system was changed since its last step is not saved", "[unit][refusals]") {
  Swing swing("dop853");
  swing.run.run_until(0.05);
  Snapshot out;
  swing.run.loop().save(out);
  REQUIRE(swing.run.loop().state().coordinates);
  swing.system.changed();
  swing.system.setup();
  check_words(message_of<ModelError>([&] { swing.run.loop().save(out); }),
              {"the run cannot be saved", "the system has changed since its last step", "continue the run first"});
}

}  // namespace refused_checkpoints_test
