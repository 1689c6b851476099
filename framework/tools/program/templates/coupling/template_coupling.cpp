// The coupling template_coupling: two wheels, each in its joint, geared with a ratio that varies.
//
// Change the function phi, the keys in info() and the checks in make(). Then change the parameters in
// test_template_coupling.cpp and scene.json, and build and run the test.
#include <lockstep/author/plugin.h>

#include <lockstep/author/phi_links.h>

namespace {

using namespace lockstep;

/// phi(a, b, t) = 0 is the coupling. a and b are the two joints: x y z of P seen from S in S's axes, m; e0 ... e3, the
/// quaternion from S to P; angle_z(), the rotation about z, rad; t, the time, s. Its derivatives are automatic.
///
///   phi = angle_1 + depth sin(angle_1) + angle_2
struct TemplateCouplingFunction {
  double depth;
  // Two joints; rotations alone, Reads::both if x y z occur as well; angle_z() counts revolutions.
  static constexpr PhiSpec spec{.pairs = 2, .reads = Reads::rotation, .counts_turns = true};

  template <class T>
  T operator()(const LockCoords<T>& a, const LockCoords<T>& b) const {
    return a.angle_z() + depth * sin(a.angle_z()) + b.angle_z();
  }
};

/// One constraint, phi = 0. The joints carry the wheels.
class TemplateCoupling final : public PhiCoupling<TemplateCouplingFunction> {
 public:
  TemplateCoupling(const CoupledPairs& pairs, TemplateCouplingFunction phi) : PhiCoupling(pairs, phi) {}
  std::string_view type() const override { return "template_coupling"; }

  /// Name, one line of help, and the keys of a scene with unit and default.
  static TypeInfo info() {
    return {"template_coupling",
            "two wheels, each rotating about its z axis: angle_2 = -(angle_1 + depth sin(angle_1))",
            {{"depth", Form::number, Unit::none, kRequired, "variation of the gear ratio, between -1 and 1"}}};
  }

  static std::unique_ptr<Lock> make(const Attachment& attachment, const Params& p) {
    if (!(std::abs(p.number("depth")) < 1))
      p.refuse("depth", "is " + text::brief(p.number("depth")) + "; must be between -1 and 1, or the gearing reverses");
    return std::make_unique<TemplateCoupling>(attachment, TemplateCouplingFunction{p.number("depth")});
  }
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.links.add<TemplateCoupling>(); }
