// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/sample_system.h"

#include <algorithm>
#include <array>

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>
#include <lockstep/function_laws.h>
#include "framework/tools/check/compare.h"
#include "framework/tools/check/draw.h"

namespace lockstep {
namespace {

constexpr SampleKind kKinds[] = {{"both bodies moving", false, false, false},
                                 {"S on the ground", true, false, false},
                                 {"P on the ground", false, true, false},
                                 {"markers moving by laws", false, false, true}};

// A smooth motion of a marker.
void move_by_laws(Marker& m, Draw& draw) {
  const Vec3 a = draw.vector(0.2), n = draw.vector(1).normalized();
  m.translation_law = laws::translation([a](auto t) {
    const auto share = sin(1.3 * t);
    return std::array{share * a[0], share * a[1], share * a[2]};
  });
  m.rotation_law = laws::rotation([n](auto t) {
    const auto half = 0.15 * sin(1.7 * t), s = sin(half);
    return QuatT<decltype(t)>{cos(half), s * n[0], s * n[1], s * n[2]};
  });
}

}  // namespace

SampleSystem::SampleSystem(const SampleKind& sample_kind, const CheckOptions& options)
    : kind(sample_kind), seed_(options.seed) {
  Draw draw(seed_);
  const MassProperties mass{1.0, draw.vector(0.1), Vec3(0.5, 0.6, 0.7).asDiagonal()};
  const auto body = [&](const char* name, bool fixed) {
    const Pose home{draw.vector(0.3), draw.turn(0.5)};
    return fixed ? &system.ground() : &system.add_body(name, mass, home);
  };
  common_ = body("S", kind.s_fixed);
  const char* names[] = {"P", "P2", "P3"};
  for (int k = 0; k < std::clamp(options.pairs, 1, 3); ++k) bodies_.push_back(body(names[k], kind.p_fixed && k == 0));
}

Attachment SampleSystem::attachment(const std::string& name) {
  Draw draw(seed_ + 1000 * system.markers().size() + 5);
  Attachment attachment{name, {}, nullptr};
  const std::string of = system.markers().empty() ? "marker " : name + ".";
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const std::string number = k == 0 ? "" : std::to_string(k + 1);
    Marker& p = system.add_marker(of + "P" + number, *bodies_[k], {draw.vector(0.2), draw.turn(0.5)});
    Marker& s = system.add_marker(of + "S" + number, *common_, {draw.vector(0.2), draw.turn(0.5)});
    if (kind.markers_move)
      for (Marker* m : {&p, &s}) move_by_laws(*m, draw);
    attachment.pairs.emplace_back(&p, &s);
  }
  return attachment;
}

CheckReport check_in_samples(const std::string& subject, const CheckOptions& options, const MakeCheck& make) {
  CheckReport report(subject, options.seed);
  for (const SampleKind& kind : kKinds) {
    SampleSystem sample(kind, options);
    CheckReport found(subject, options.seed);
    std::function<void(CheckReport&)> check;
    try {
      check = make(sample);
      if (!completes(report, [&] { sample.system.setup(); })) break;
    } catch (const ModelError& error) {
      if (&kind == kKinds) throw;
      report.note(fmt::format("not checked with {}: {}", kind.name, error.what()));
      continue;
    }
    check(found);
    report.take(found);
    if (found.ok()) continue;
    report.note(fmt::format("the findings are from the test system with {}", kind.name));
    break;
  }
  return report;
}

}  // namespace lockstep
