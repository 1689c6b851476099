// The joint template_link: the point P rides on a wavy rail that is fixed to S.
//
// Change three things: the function phi, the keys in info(), and what make() refuses. Then build and run the test.
#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

/// phi(y, t) = 0 is the joint. y.x y.y y.z: P seen from S in S's axes, m; y.e0 ... y.e3: the quaternion from S to P;
/// y.angle_z(): the turn about z; y.t: the time. Write it as a formula; its derivatives are exact, and nobody writes
/// them.
///
///   phi = z - height (1 - cos(2 pi x/length))/2
struct TemplateLinkFunction {
  double height, length;
  // x y z alone, Reads::both where e or angle_z() occur; phi is a length, RowKind::function for anything else.
  static constexpr PhiSpec spec{.reads = Reads::translation, .kind = RowKind::translation};

  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::cos;
    return y.z - 0.5 * height * (1.0 - cos(kTwoPi / length * y.x));
  }
};

/// Rows: y = 0 (the rail lies in the xz plane of S), and phi = 0.
class TemplateLink final : public PhiLock<TemplateLinkFunction> {
 public:
  TemplateLink(std::string name, Marker& p, Marker& s, TemplateLinkFunction phi)
      : PhiLock(std::move(name), p, s, Mask::y, phi) {}
  std::string_view type() const override { return "template_link"; }

  /// Name, one line of help, and the keys: what scenes may say, in which unit, with which default.
  static TypeInfo info() {
    return {
        "template_link",
        "P rides on a wavy rail in the xz plane of S: z = height (1 - cos(2 pi x/length))/2; free: along it, all turns",
        {{"height", Form::number, Unit::length, kRequired, "of the waves, from lowest to highest"},
         {"length", Form::number, Unit::length, 1, "of one wave, above zero"}}};
  }

  static std::unique_ptr<Lock> make(const Attachment& attachment, const Params& p) {
    if (!(p.number("length") > 0))
      p.refuse("length", "is " + text::brief(p.number("length")) + " m; must be above zero");
    return std::make_unique<TemplateLink>(attachment.name, attachment.p(), attachment.s(),
                                          TemplateLinkFunction{p.number("height"), p.number("length")});
  }
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.links.add<TemplateLink>(); }
