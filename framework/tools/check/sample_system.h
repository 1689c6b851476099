// SampleSystem: bodies and markers between which a registered type is tried.
#pragma once

#include <string>
#include <vector>

#include <lockstep/check.h>
#include <lockstep/params.h>
#include <lockstep/system.h>

namespace lockstep {

enum class SampleKind { moving, s_on_ground, p_on_ground, markers_move };
inline constexpr SampleKind kAllSamples[] = {SampleKind::moving, SampleKind::s_on_ground, SampleKind::p_on_ground,
                                             SampleKind::markers_move};
/// "both bodies moving", "S on the ground", ...
const char* words_of(SampleKind);

/// Bodies "a", "b", ... with a P each, and "common" with every S; markers of their own for each thing that is tried.
class SampleSystem {
 public:
  SampleSystem(SampleKind kind, const CheckOptions& options);
  /// Markers for one more thing of this name: options.pairs pairs.
  Attachment attachment(const std::string& name);

  System system;

 private:
  SampleKind kind_;
  std::uint64_t seed_;
  std::vector<Body*> bodies_;
  Body* common_ = nullptr;
};

}  // namespace lockstep
