#include "framework/tools/check/sample_system.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>
#include "framework/tools/check/draw.h"

namespace lockstep {
namespace {

constexpr const char* kKindNames[] = {"both bodies moving", "S on the ground", "P on the ground",
                                      "markers moving by laws"};

// Smooth motions of markers, with exact derivatives.
struct Sway final : TranslationLaw {
  explicit Sway(const Vec3& to) : a(to) {}
  TranslationValue at(double t) const override {
    return {std::sin(1.3 * t) * a, 1.3 * std::cos(1.3 * t) * a, -1.69 * std::sin(1.3 * t) * a};
  }
  Vec3 a;
};
struct Wag final : RotationLaw {
  explicit Wag(const Vec3& axis) : n(axis.normalized()) {}
  RotationValue at(double t) const override {
    return {axis_angle(n, 0.3 * std::sin(1.7 * t)), 0.51 * std::cos(1.7 * t) * n, -0.867 * std::sin(1.7 * t) * n};
  }
  Vec3 n;
};

}  // namespace

SampleSystem::SampleSystem(SampleKind sample_kind, const CheckOptions& options)
    : kind(sample_kind), seed_(options.seed) {
  Draw draw(seed_);
  const MassProperties mass{1.0, draw.vector(0.1), Vec3(0.5, 0.6, 0.7).asDiagonal()};
  const auto body = [&](const char* name, bool fixed) {
    const Pose home{draw.vector(0.3), draw.turn(0.5)};
    return fixed ? &system.ground() : &system.add_body(name, mass, home);
  };
  common_ = body("common", kind == SampleKind::s_on_ground);
  const char* names[] = {"a", "b", "c"};
  for (int k = 0; k < std::clamp(options.pairs, 1, 3); ++k)
    bodies_.push_back(body(names[k], kind == SampleKind::p_on_ground && k == 0));
}

Attachment SampleSystem::attachment(const std::string& name) {
  Draw draw(seed_ + 1000 * system.markers().size() + 5);
  Attachment attachment{name, {}, nullptr};
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const std::string of = name + (k == 0 ? "" : std::to_string(k + 1));
    Marker& p = system.add_marker(of + ".P", *bodies_[k], {draw.vector(0.2), draw.turn(0.5)});
    Marker& s = system.add_marker(of + ".S", *common_, {draw.vector(0.2), draw.turn(0.5)});
    if (kind == SampleKind::markers_move) {
      p.translation_law = std::make_shared<Sway>(draw.vector(0.2)),
      p.rotation_law = std::make_shared<Wag>(draw.vector(1));
      s.translation_law = std::make_shared<Sway>(draw.vector(0.2)),
      s.rotation_law = std::make_shared<Wag>(draw.vector(1));
    }
    attachment.pairs.emplace_back(&p, &s);
  }
  return attachment;
}

CheckReport check_in_samples(const std::string& subject, const CheckOptions& options, const MakeCheck& make) {
  CheckReport report(subject, options.seed);
  for (const SampleKind kind :
       {SampleKind::moving, SampleKind::s_on_ground, SampleKind::p_on_ground, SampleKind::markers_move}) {
    const char* name = kKindNames[static_cast<int>(kind)];
    SampleSystem sample(kind, options);
    CheckReport found(subject, options.seed);
    std::function<void(CheckReport&)> check;
    try {
      check = make(sample);
      sample.system.setup();
    } catch (const UserCodeError& error) {
      report.add("setup", {error.what(), "what it says"});
      break;
    } catch (const ModelError& error) {
      if (kind == SampleKind::moving) throw;
      report.note(fmt::format("not tried with {}: {}", name, error.what()));
      continue;
    }
    check(found);
    report.take(found);
    if (found.ok()) continue;
    report.note(fmt::format("the first findings came with {}", name));
    break;
  }
  return report;
}

}  // namespace lockstep
