// SPDX-License-Identifier: BSD-3-Clause
// SampleSystem: bodies and markers for the check of a registered type.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include <lockstep/author/params.h>
#include <lockstep/system.h>

namespace lockstep {

struct SampleKind {
  const char* name;  ///< "S on the ground"
  bool s_fixed, p_fixed, markers_move;
};

/// Bodies "P", "P2", ... that carry a P each, and "S" that carries every S. Each object gets its own markers; those of
/// the first are "marker P", "marker S", "marker P2", ...
class SampleSystem {
 public:
  SampleSystem(const SampleKind& kind, const CheckOptions& options);
  /// Markers for one more object of this name: options.pairs pairs.
  Attachment attachment(const std::string& name);

  System system;
  const SampleKind& kind;

 private:
  std::uint64_t seed_;
  std::vector<Body*> bodies_;
  Body* common_ = nullptr;
};

/// Adds the objects under check to the system and returns their check.
using MakeCheck = std::function<std::function<void(CheckReport&)>(SampleSystem&)>;

/// Makes and runs a check in each kind of sample system until one of them reports findings. What the maker rejects is
/// thrown in the first and noted in the others.
CheckReport check_in_samples(const std::string& subject, const CheckOptions&, const MakeCheck&);

}  // namespace lockstep
