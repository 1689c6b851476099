// SPDX-License-Identifier: BSD-3-Clause
// The library's one logger: a host redirects it, sets its level, silences it.
#include <lockstep/log.h>

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include <lockstep/assembly.h>
#include <lockstep/step_loop.h>
#include <lockstep/solvers.h>
#include <lockstep/joints.h>
#include <lockstep/system.h>
#include <lockstep/integrators.h>
#include "tests/support/catch.h"

namespace log_test {

using namespace lockstep;

namespace {

// What the library says while this lives.
struct Heard {
  std::ostringstream words;
  Heard() {
    auto own = std::make_shared<spdlog::logger>("host", std::make_shared<spdlog::sinks::ostream_sink_mt>(words));
    own->set_pattern("%n/%l: %v");
    set_logger(own);
  }
  ~Heard() { spdlog::drop("lockstep"); }  // the next call makes the library's own again
  bool has(const std::string& part) const { return words.str().find(part) != std::string::npos; }
};

}  // namespace

TEST_CASE("a host redirects, levels and silences the logger", "[unit][support]") {
  {
    Heard heard;
    log_warning("the rod is thin");
    CHECK(heard.words.str() == "lockstep/warning: the rod is thin\n");
    log_info("a word");
    CHECK(heard.has("lockstep/info: a word"));
    logger()->set_level(spdlog::level::err);
    log_warning("not heard");
    CHECK_FALSE(heard.has("not heard"));
    set_logger(nullptr);
    log_warning("not heard either");
    CHECK_FALSE(heard.has("not heard"));
  }
  CHECK(logger()->name() == "lockstep");
  CHECK(logger() == spdlog::get("lockstep"));
  CHECK(logger()->level() == spdlog::level::warn);
}

TEST_CASE("warnings of a run are logged and are in its report", "[unit][support]") {
  System system({.gravity = {0, 0, -9.81}});
  system.add_particle("bob", 1.0, {0, 0, 0});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 0.01});
  Heard heard;
  run.add_finding({&finding_kind("event-at-zero"), "event 'late'", "event 'late' never comes"});
  CHECK(heard.has("lockstep/warning: event-at-zero: event 'late' never comes"));
  REQUIRE(run.report().findings.size() == 1);
  CHECK(run.report().findings.front().text() == "event 'late' never comes");
  run.run_until(0.05);
  CHECK(run.report().findings.size() == 1);
  run.set_state(system.start());  // a new run
  CHECK(run.report().findings.empty());
}

TEST_CASE("bodies moved by assembly are reported", "[unit][support]") {
  System system;
  Body& bob = system.add_particle("bob", 1.0, {1.1, 0, 0});
  Marker& p = system.add_marker("p", bob);
  Marker& s = system.add_marker("s", system.ground());
  system.add<Distance>("rope", p, s, 1.0);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  State start = system.start();
  Heard heard;
  const AssemblyReport report = assemble(dynamics, start);
  CHECK(report.is_notable());
  CHECK(heard.has("lockstep/info: the given poses violated the constraints by 0.1 m"));
  CHECK(heard.has("moved 'bob' by 0.1 m"));
  CHECK(heard.has("start-moved"));
  const std::size_t said = heard.words.str().size();
  assemble(dynamics, start);
  CHECK(heard.words.str().size() == said);  // nothing to say the second time
}

}  // namespace log_test
