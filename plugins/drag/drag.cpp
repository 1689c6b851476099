// SPDX-License-Identifier: BSD-3-Clause
// A force as a plugin: the drag of air at rest on the point P.
//
//   F = -c |v| v at P,   v: velocity of P in the world,   c = coefficient, or density area shape/2
#include <lockstep/author/force.h>
#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

class Drag final : public FormulaForce<Drag> {
 public:
  /// c: N s^2/m^2, not negative.
  Drag(std::string name, Marker& p, double c) : FormulaForce(std::move(name), p, nullptr), c_(c) {}
  std::string_view type() const override { return "drag"; }

  /// It acts against the velocity of P.
  bool stays_in_plane(Plane plane) const override { return markers_stay_in(plane); }

  /// On numbers this is the force, on jets its exact tangent.
  template <class T, class Load>
  void act(const Ends<T>& at, Load& load) const {
    const Vec3T<T> v = at.P.v();
    const T speed = norm(v);
    load.force(-c_ * speed * v, at.P.x());
    load.dissipates(c_ * speed * speed * speed);  // the power lost to the air
  }

  static TypeInfo info() {
    return {"drag",
            "air drag on P, against its velocity and quadratic in speed: by coefficient, or by density and area",
            {{"coefficient", Form::number, Unit::any, kOptional, "force per speed squared, N s^2/m^2"},
             {"density", Form::number, Unit::density, 1.2, "of the air"},
             {"area", Form::number, Unit::any, kOptional, "frontal area, m^2"},
             {"shape", Form::number, Unit::none, 1, "drag coefficient: 0.47 a ball, 1.2 a cylinder across"}}};
  }

  static std::unique_ptr<Force> make(const Attachment& attachment, const Params& k) {
    if (k.has("coefficient") == k.has("area")) k.refuse("coefficient", "and area: give one of the two");
    for (const char* key : {"coefficient", "density", "area", "shape"})
      if (k.has(key) && !(k.number(key) >= 0))
        k.refuse(key, "is " + text::brief(k.number(key)) + "; must not be negative");
    const double c =
        k.has("area") ? 0.5 * k.number("density") * k.number("area") * k.number("shape") : k.number("coefficient");
    return std::make_unique<Drag>(attachment.name, p_of(attachment, k), c);
  }

 private:
  double c_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.forces.add<Drag>(); }
