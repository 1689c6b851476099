// SPDX-License-Identifier: BSD-3-Clause
// What a scene that cannot be is refused with.
#pragma once

#include <memory>
#include <string>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/sweep.h>
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"

namespace lockstep::testing {

/// The message, which names a line of the text; "accepted" for a scene that is built, with its recorder and events.
inline std::string refusal_of(const std::string& text) {
  const Registry registry = builtin_registry();
  try {
    Mechanism m = build_mechanism(scene_from_text(text, "bad.json"), registry);
    const std::unique_ptr<Recorder> recorder = make_recorder(m);
    make_events(m, *recorder);
  } catch (const SceneError& error) {
    CHECK(error.line > 0);
    return error.what();
  }
  return "accepted";
}

}  // namespace lockstep::testing
