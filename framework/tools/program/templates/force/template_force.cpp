// The force template_force: P and S attract each other with the inverse square of their distance.
//
// Change the formula in act(), the keys in info() and the checks in make(). Then change the parameters in
// test_template_force.cpp and scene.json, and build and run the test.
#include <lockstep/author/force.h>
#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

///   F = -strength d/|d|^3 on P, d = x_P - x_S, and -F on S;   V = -strength/|d|
class TemplateForce final : public FormulaForce<TemplateForce> {
 public:
  TemplateForce(std::string name, Marker& p, Marker& s, double strength)
      : FormulaForce(std::move(name), p, &s), strength_(strength) {}
  std::string_view type() const override { return "template_force"; }

  /// T is double, or a jet that carries the exact tangent. at.P and at.S give x(), v(), w() (world) and the axes A();
  /// at.t is the time. A load takes force() and torque() between the bodies, and the terms of the energy balance:
  /// stores() J, dissipates() W of dampers, supplies() W of the force's own laws.
  template <class T, class Load>
  void act(const Ends<T>& at, Load& load) const {
    const Vec3T<T> d = at.P.x() - at.S.x();
    const T r = norm(d);
    load.force(-strength_ / (r * r * r) * d, at.P.x(), at.S.x());
    load.stores(-strength_ / r);
  }

  /// Name, one line of help, and the keys of a scene with unit and default.
  static TypeInfo info() {
    return {"template_force",
            "P and S attract each other with the inverse square of their distance",
            {{"strength", Form::number, Unit::any, kRequired, "force times distance squared, N m^2"}}};
  }

  static std::unique_ptr<Force> make(const Attachment& attachment, const Params& p) {
    if (!(p.number("strength") >= 0))
      p.refuse("strength", "is " + text::brief(p.number("strength")) + " N m^2; must not be negative");
    return std::make_unique<TemplateForce>(attachment.name, p_of(attachment, p), s_of(attachment, p),
                                           p.number("strength"));
  }

 private:
  double strength_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.forces.add<TemplateForce>(); }
