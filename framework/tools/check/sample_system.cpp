#include "framework/tools/check/sample_system.h"

#include <algorithm>
#include <cmath>

#include "framework/tools/check/draw.h"

namespace lockstep {
namespace {

// Slides and turns of markers: smooth, with exact derivatives.
class Sway final : public TranslationLaw {
 public:
  explicit Sway(const Vec3& a) : a_(a) {}
  TranslationValue at(double t) const override {
    return {std::sin(1.3 * t) * a_, 1.3 * std::cos(1.3 * t) * a_, -1.69 * std::sin(1.3 * t) * a_};
  }

 private:
  Vec3 a_;
};
class Wag final : public RotationLaw {
 public:
  explicit Wag(const Vec3& axis) : n_(axis.normalized()) {}
  RotationValue at(double t) const override {
    return {axis_angle(n_, 0.3 * std::sin(1.7 * t)), 0.51 * std::cos(1.7 * t) * n_, -0.867 * std::sin(1.7 * t) * n_};
  }

 private:
  Vec3 n_;
};

}  // namespace

const char* words_of(SampleKind kind) {
  switch (kind) {
    case SampleKind::moving:
      return "both bodies moving";
    case SampleKind::s_on_ground:
      return "S on the ground";
    case SampleKind::p_on_ground:
      return "P on the ground";
    default:
      return "markers moving by laws";
  }
}

SampleSystem::SampleSystem(SampleKind kind, const CheckOptions& options) : kind_(kind), seed_(options.seed) {
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
    if (kind_ == SampleKind::markers_move) {
      p.translation_law = std::make_shared<Sway>(draw.vector(0.2)), p.rotation_law = std::make_shared<Wag>(draw.vector(1));
      s.translation_law = std::make_shared<Sway>(draw.vector(0.2)), s.rotation_law = std::make_shared<Wag>(draw.vector(1));
    }
    attachment.pairs.emplace_back(&p, &s);
  }
  return attachment;
}

}  // namespace lockstep
