// The joint template_joint: the point P moves on a wavy rail that is fixed to S.
//
// Change the function phi, the keys in info() and the checks in make(). Then change the parameters in
// test_template_joint.cpp and scene.json, and build and run the test.
#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

/// phi(y, t) = 0 is the joint. y.x y.y y.z: P seen from S in S's axes, m; y.e0 ... y.e3: the quaternion from S to P;
/// y.angle_z(): the rotation about z, rad; y.t: the time, s. Write it as a formula; its derivatives are exact and
/// automatic. Branches must meet with equal value, slope and curvature: the test may miss one that does not.
///
///   phi = z - height (1 - cos(2 pi x/length))/2
///
/// Its multiplier is a force in N only if the gradient of phi has length one: record rail.force_on_p_world_z instead.
struct TemplateJointFunction {
  double height, length;
  // x y z alone, Reads::both if e or angle_z() occur; phi is a length, RowKind::function for anything else.
  static constexpr PhiSpec spec{.reads = Reads::translation, .kind = RowKind::translation};

  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.5 * height * (1.0 - cos(kTwoPi / length * y.x));
  }
};

/// Constraints: y = 0 (the rail is in the xz plane of S), and phi = 0.
class TemplateJoint final : public PhiLock<TemplateJointFunction> {
 public:
  TemplateJoint(std::string name, Marker& p, Marker& s, TemplateJointFunction phi)
      : PhiLock(std::move(name), p, s, Mask::y, phi) {}
  std::string_view type() const override { return "template_joint"; }

  /// Name, one line of help, and the keys of a scene with unit and default.
  static TypeInfo info() {
    return {
        "template_joint",
        "P moves on a wavy rail in the xz plane of S: z = height (1 - cos(2 pi x/length))/2; free: along it, rotation",
        {{"height", Form::number, Unit::length, kRequired, "height of the waves"},
         {"length", Form::number, Unit::length, 1, "length of one wave, above zero"}}};
  }

  static std::unique_ptr<Lock> make(const Attachment& attachment, const Params& p) {
    if (!(p.number("length") > 0))
      p.refuse("length", "is " + text::brief(p.number("length")) + " m; must be above zero");
    return std::make_unique<TemplateJoint>(attachment.name, attachment.p(), attachment.s(),
                                           TemplateJointFunction{p.number("height"), p.number("length")});
  }
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.links.add<TemplateJoint>(); }
