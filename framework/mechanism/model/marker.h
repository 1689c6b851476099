// Marker: a frame on a body, still or moving by two laws.
#pragma once

#include <string>

#include "framework/mechanism/model/body.h"
#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

struct Marker {
  std::string name;
  Body* body = nullptr;
  Pose local;  ///< in the body's frame
  LawPtr<TranslationLaw>
      slide{};  ///< moves the marker along its own home axes (those of `local`); absent: it does not slide
  LawPtr<RotationLaw> spin{};  ///< turns it about them; absent: it does not turn
};

}  // namespace lockstep
