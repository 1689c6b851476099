// A force as a plugin: the drag of the air, which is at rest, on the point P.
//
//   F = -c |v| v at P,   v: velocity of P in the world,   c = coefficient, or density area shape/2
#include "framework/mechanism/forces/marker_force.h"
#include "framework/mechanism/forces/variation.h"
#include "framework/description/registry/plugin.h"

namespace {

using namespace lockstep;

class Drag final : public MarkerForce {
 public:
  /// c: N s^2/m^2, not negative.
  Drag(std::string name, Marker& p, double c) : MarkerForce(std::move(name), p, nullptr), c_(c) {}
  std::string_view type() const override { return "drag"; }

  void apply(const Inputs& in, WrenchSum& out) const override {
    const MarkerInWorld P = in_world(P_, in);
    out.force(P_.slot, -c_ * P.v.norm() * P.v, P.x);
  }
  /// The formula of apply() once more, with the derivatives that come along.
  void tangent(const Inputs& in, TangentSum& out) const override {
    const Variation at(in, P_, S_);
    const VaryingVector v = at.velocity(0);
    if (v.v.isZero(0)) return;  // |v| v is flat there
    at.force(0, -(c_ * norm(v) * v), at.point(0), out);
  }
  /// c |v|^3: all that the air takes.
  double dissipation(const Inputs& in) const override { return c_ * std::pow(in_world(P_, in).v.norm(), 3); }
  /// What a law gives that slides P along its body: the body itself moves with another velocity than P.
  double supply(const Inputs& in) const override {
    const MarkerInWorld P = in_world(P_, in);
    return -c_ * P.v.norm() * P.v.dot(point_velocity(in, P_.slot, P.x) - P.v);
  }

  static TypeInfo info() {
    return {"drag",
            "drag of the air on P, against its velocity and as its square: by coefficient, or by density and area",
            {{"coefficient", Form::number, Unit::any, kOptional, "force per speed squared, N s^2/m^2"},
             {"density", Form::number, Unit::density, 1.2, "of the air"},
             {"area", Form::number, Unit::any, kOptional, "seen along the motion, m^2"},
             {"shape", Form::number, Unit::none, 1, "drag coefficient: 0.47 a ball, 1.2 a cylinder across"}}};
  }

  static std::unique_ptr<Force> make(const Site& site, const Params& k) {
    if (k.has("coefficient") == k.has("area")) k.refuse("coefficient", "and area: give one of the two");
    for (const char* key : {"coefficient", "density", "area", "shape"})
      if (k.has(key) && !(k.number(key) >= 0)) k.refuse(key, "is " + brief(k.number(key)) + "; must not be negative");
    const double c =
        k.has("area") ? 0.5 * k.number("density") * k.number("area") * k.number("shape") : k.number("coefficient");
    return std::make_unique<Drag>(site.name, p_of(site, k), c);
  }

 private:
  double c_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.forces.add<Drag>(); }
