// The force template_force: P and S attract each other with the inverse square of their distance.
//
// Change four things: the formula in apply(), the energies, the keys in info(), and what make() refuses. Then build and
// run the test.
#include "framework/mechanism/forces/marker_force.h"
#include "framework/description/registry/plugin.h"

namespace {

using namespace lockstep;

///   F = -strength d/|d|^3 on P, d = x_P - x_S, and -F on S;   V = -strength/|d|
class TemplateForce final : public MarkerForce {
 public:
  TemplateForce(std::string name, Marker& p, Marker& s, double strength)
      : MarkerForce(std::move(name), p, &s), strength_(strength) {}
  std::string_view type() const override { return "template_force"; }

  /// P_ and S_ are the folded markers: in_world() gives their x, v, w (world) and axes A.
  void apply(const Inputs& in, WrenchSum& out) const override {
    const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
    const Vec3 d = P.x - S.x;
    const Vec3 F = -strength_ / std::pow(d.norm(), 3) * d;
    out.force(P_.slot, F, P.x);
    out.force(S_.slot, -F, S.x);
  }

  // -- energies: the balance of a run rests on them
  /// J; minus its gradient is the force.
  double potential(const Inputs& in) const override {
    return -strength_ / (in_world(P_, in).x - in_world(S_, in).x).norm();
  }
  /// W that dampers take out.
  double dissipation(const Inputs&) const override { return 0; }
  /// W that laws and motors give; here what it takes to move P and S on their bodies, if laws do so.
  double supply(const Inputs& in) const override {
    const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
    const Vec3 d = P.x - S.x, F = -strength_ / std::pow(d.norm(), 3) * d;
    return F.dot(point_velocity(in, P_.slot, P.x) - P.v) - F.dot(point_velocity(in, S_.slot, S.x) - S.v);
  }

  /// Name, one line of help, and the keys: what scenes may say, in which unit, with which default.
  static TypeInfo info() {
    return {"template_force",
            "P and S attract each other with the inverse square of their distance",
            {{"strength", Form::number, Unit::any, kRequired, "force times distance squared, N m^2"}}};
  }

  static std::unique_ptr<Force> make(const Site& site, const Params& p) {
    if (!(p.number("strength") >= 0))
      p.refuse("strength", "is " + brief(p.number("strength")) + " N m^2; must not be negative");
    return std::make_unique<TemplateForce>(site.name, p_of(site, p), s_of(site, p), p.number("strength"));
  }

 private:
  double strength_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.forces.add<TemplateForce>(); }
