// SPDX-License-Identifier: BSD-3-Clause
// A joint as a plugin: the point P of a follower rides on the profile of a disc cam whose axis is z of S.
#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

/// phi = r - F(psi): P in polar coordinates of the cam's axes, F(psi) = base + (lift/2)(1 - cos(lobes psi)).
/// No derivative is written here: lockstep evaluates phi on jets.
struct CamProfile {
  double base, lift, lobes;
  // The turn of P does not matter, a planar mechanism stays in its plane, and phi is a length.
  static constexpr PhiSpec spec{.reads = Reads::translation, .stays_in_plane = true, .kind = RowKind::translation};

  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::atan2, std::cos, std::sqrt;
    const T r = sqrt(y.x * y.x + y.y * y.y), psi = atan2(y.y, y.x);
    return r - (base + 0.5 * lift * (1.0 - cos(lobes * psi)));
  }
};

/// Free: everything but the distance of P from the cam's axis, which the profile sets. The joint holds both ways: the
/// follower cannot lift off (a spring is not needed).
class CamFollower final : public PhiLock<CamProfile> {
 public:
  CamFollower(std::string name, Marker& p, Marker& s, CamProfile profile)
      : PhiLock(std::move(name), p, s, Mask::none, profile) {}
  std::string_view type() const override { return "cam_follower"; }

  static TypeInfo info() {
    return {"cam_follower",
            "P on a disc cam about z of S, r = base + lift/2 (1 - cos lobes psi); degrees of freedom left: all but one",
            {{"base", Form::number, Unit::length, kRequired, "smallest radius, above zero"},
             {"lift", Form::number, Unit::length, kRequired, "largest radius less the smallest"},
             {"lobes", Form::integer, Unit::none, 1, "rises per revolution, at least 1"}}};
  }

  static std::unique_ptr<Lock> make(const Attachment& attachment, const Params& p) {
    if (!(p.number("base") > 0))
      p.refuse("base", "is " + text::brief(p.number("base")) + " m; a cam has a radius above zero");
    if (p.integer("lobes") < 1)
      p.refuse("lobes", "is " + std::to_string(p.integer("lobes")) + "; a cam has at least one");
    return std::make_unique<CamFollower>(attachment.name, attachment.p(), attachment.s(),
                                         CamProfile{p.number("base"), p.number("lift"), double(p.integer("lobes"))});
  }
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.links.add<CamFollower>(); }
