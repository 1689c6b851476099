// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/outcome.h"

#include <algorithm>
#include <memory>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/sweep.h>

namespace lockstep::stability {

Outcome outcome_of(const std::string& text) {
  Outcome out;
  const Registry& registry = builtin_registry();
  std::unique_ptr<Recorder> recorder;
  try {
    Mechanism m = build_mechanism(scene_from_text(text, "scene.json"), registry);
    recorder = make_recorder(m);
    std::vector<Event> events = make_events(m, *recorder);
    EnergyAudit audit(system_of(m), m.run.limits);
    Dynamics dynamics(system_of(m), make_solver(m.run, registry), {m.run.formulation, m.run.stabilization});
    AssemblyReport assembled;
    State start = assembled_start(dynamics, m, &assembled);
    StepLoop loop(dynamics, make_integrator(m.run, registry),
                  {.step = m.run.step,
                   .tolerance = m.run.tolerance,
                   .output = m.run.output,
                   .output_times = m.run.times,
                   .max_steps = m.run.max_steps});
    loop.add_observer(*recorder), loop.add_observer(audit);
    for (Event& event : events) loop.add_event(std::move(event));
    loop.set_state(std::move(start));
    try {
      loop.run_until(std::max(m.run.until, 0.0));
    } catch (const Error& error) {
      out.error = error.what();
    }
    out.table = recorder->table(), out.audit = audit.result(), out.report = loop.report();
    out.report.findings.insert(out.report.findings.end(), assembled.findings.begin(), assembled.findings.end());
  } catch (const Error& error) {
    out.error = error.what();
  }
  return out;
}

std::string filled(std::string text, const std::string& word, const std::string& value) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + value.size()))
    text.replace(at, word.size(), value);
  return text;
}

std::string filled(std::string text, const std::string& word, double value) {
  return filled(std::move(text), word, fmt::format("{:.17g}", value));
}

}  // namespace lockstep::stability
