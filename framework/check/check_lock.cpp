#include "framework/check/check_lock.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/check/lock_check.h"
#include "framework/support/error.h"
#include "framework/support/text.h"

namespace lockstep {
namespace {

// Slides and turns of sample markers: smooth, with exact derivatives.
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

enum class Sample { moving, s_on_ground, p_on_ground, markers_move };

// Bodies a, b, ... and a common one; two links of the type between them, for the test of groups.
void build(System& system, Sample sample, const Registry& registry, const std::string& type, const Params& params,
           const CheckOptions& options, std::vector<Lock*>& links) {
  Draw draw(options.seed);
  const MassProperties mass{1.0, draw.vector(0.1), Vec3(0.5, 0.6, 0.7).asDiagonal()};
  const auto body = [&](const char* name, bool fixed) -> Body& {
    const Pose home{draw.vector(0.3), draw.turn(0.5)};
    return fixed ? system.ground() : system.add_body(name, mass, home);
  };
  Body& common = body("common", sample == Sample::s_on_ground);
  const char* names[] = {"a", "b", "c", "d"};
  std::vector<Body*> bodies;
  for (int k = 0; k < std::min(options.pairs, 3); ++k)
    bodies.push_back(&body(names[k], sample == Sample::p_on_ground && k == 0));
  for (const char* name : {"first", "second"}) {
    Site site{name, {}, nullptr};
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const std::string of = name + std::string(k == 0 ? "" : std::to_string(k + 1));
      Marker& p = system.add_marker(of + ".P", *bodies[k], {draw.vector(0.2), draw.turn(0.5)});
      Marker& s = system.add_marker(of + ".S", common, {draw.vector(0.2), draw.turn(0.5)});
      if (sample == Sample::markers_move) {
        p.slide = std::make_shared<Sway>(draw.vector(0.2)), p.spin = std::make_shared<Wag>(draw.vector(1));
        s.slide = std::make_shared<Sway>(draw.vector(0.2)), s.spin = std::make_shared<Wag>(draw.vector(1));
      }
      site.pairs.emplace_back(&p, &s);
    }
    links.push_back(&system.add(registry.links.make(type, site, params, &registry, fmt::format("link '{}'", name))));
  }
}

const char* words_of(Sample sample) {
  switch (sample) {
    case Sample::moving:
      return "both bodies moving";
    case Sample::s_on_ground:
      return "S on the ground";
    case Sample::p_on_ground:
      return "P on the ground";
    default:
      return "markers moving by laws";
  }
}

}  // namespace

CheckReport check_lock(System& system, const Lock& link, const CheckOptions& options) {
  const auto& all = system.links();
  if (std::none_of(all.begin(), all.end(), [&](const auto& l) { return l.get() == &link; }))
    throw ModelError(fmt::format("check_lock: link '{}' is not in the system; add it by System::add", link.name()));
  system.setup();
  CheckReport report(fmt::format("link '{}' ({})", link.name(), link.type()), options.seed);
  LockCheck(system, link, nullptr, report, options).run();
  return report;
}

CheckReport check_lock(const Registry& registry, const std::string& type, const Params& params,
                       const CheckOptions& options) {
  CheckReport report(fmt::format("link type '{}'", type), options.seed);
  for (const Sample sample : {Sample::moving, Sample::s_on_ground, Sample::p_on_ground, Sample::markers_move}) {
    System system;
    std::vector<Lock*> links;
    build(system, sample, registry, type, params, options, links);
    system.setup();
    CheckReport one(report.subject(), options.seed);
    LockCheck(system, *links[0], links[1], one, options).run();
    report.take(one);
    if (one.ok()) continue;
    report.note(fmt::format("the first findings came with {}", words_of(sample)));
    break;
  }
  return report;
}

}  // namespace lockstep
