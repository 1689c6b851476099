#include "framework/mechanism/links/functions.h"

#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"

namespace lockstep {
namespace {

class Held final : public MotionLaw {
 public:
  explicit Held(double value) : value_(value) {}
  LawValue at(double) const override { return {value_, 0, 0}; }

 private:
  double value_;
};

double home_distance(const Marker& p, const Marker& s) {
  return ((p.body->home * p.local).x - (s.body->home * s.local).x).norm();
}

}  // namespace

Distance::Distance(std::string name, Marker& p, Marker& s, double length)
    : Distance(std::move(name), p, s, std::make_shared<Held>(length)) {}

Distance::Distance(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> length)
    : PhiLock(std::move(name), p, s, Mask::none, DistanceFunction{std::move(length)}) {
  if (!phi().length)
    throw ModelError("link '" + this->name() + "': no law of its length was given; give one, or a number");
}

Distance::Distance(std::string name, Marker& p, Marker& s) : Distance(std::move(name), p, s, home_distance(p, s)) {}

void Distance::setup() {
  PhiLock::setup();
  const double length = phi().length->at(0.0).y;
  if (!(length > 0))
    throw ModelError("link '" + name() + "': length " + brief(length) +
                     " m at t = 0; a distance must be above zero (two points that coincide are a spherical joint)");
  if (home_distance(p(), s()) == 0)
    throw ModelError("link '" + name() + "': '" + p().name + "' and '" + s().name +
                     "' start at one point, so the distance has no direction; move one of them");
}

TypeInfo Distance::info() {
  return {"distance",
          "keeps the distance of the origins of P and S; free: everything else",
          {{"length", Form::law, Unit::length, kOptional, "distance, m: a number or a law; default: as at the start"}}};
}

std::unique_ptr<Lock> Distance::make(const Site& site, const Params& params) {
  if (!params.has("length")) return std::make_unique<Distance>(site.name, site.p(), site.s());
  return std::make_unique<Distance>(site.name, site.p(), site.s(), params.law("length"));
}

}  // namespace lockstep
