// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/lock/coordinate.h"

#include <memory>
#include <optional>
#include <string>

namespace lockstep {

MarkerFrame BodyOrMarker::folded() const {
  if (marker != nullptr) return MarkerFrame(*marker);
  MarkerFrame f;
  if (body == nullptr) return f;
  f.slot = body->slot;
  if (center) return f;
  const Pose& p = body->fixed ? body->home : body->in_slot;
  f.u0 = f.home.u = p.x, f.q0 = f.home.q = normalized(p.q), f.A0 = f.home.A = rotation(f.q0);
  return f;
}

Dimension Coordinate::dimension() const {
  Dimension d = dimension_of(turns() ? Unit::angle : Unit::length);
  if (of_.kind == Kind::quaternion) d = {};
  d.s = -of_.order;
  return d;
}

namespace {

const std::string& name_of(const BodyOrMarker& f) { return f.marker ? f.marker->name : f.body->name; }

// The angle of a frame's own next axis, for planar motion: angle_z is that of its x axis. It is undefined if that axis is
// along k.
class HeadingAngle final : public CountedAngle {
 public:
  explicit HeadingAngle(const Coordinate& q)
      : CountedAngle(std::string("angle_") + "xyz"[q.of().axis] + " of '" + name_of(q.from()) + "'" +
                     (q.to().body ? " seen from '" + name_of(q.to()) + "'" : "")),
        q_(q) {}
  void setup() override { q_.setup(); }
  std::optional<Turn> turn() const override {
    if (q_.m().rotation_law || q_.n().rotation_law) return {};
    return Turn{q_.m().slot, q_.n().slot, rotation(q_.n().at(0).q).col(q_.of().axis)};
  }

 protected:
  double angle(const Inputs& in) const override { return q_.value(marker_on(q_.m(), in), marker_on(q_.n(), in), {}); }
  double rate_of_pose(const Inputs& in) const override {
    return q_.rate(marker_on(q_.m(), in), marker_on(q_.n(), in), Vec3(Vec3::Zero()));
  }

 private:
  Coordinate q_;
};

}  // namespace

void Coordinate::count_angles(AngleCounter& counter) {
  if (of_.kind == Kind::turn) angle_ = &counter.count(*m_.marker, *n_.marker, of_.axis);
  if (of_.kind == Kind::heading) angle_ = &counter.count(std::make_unique<HeadingAngle>(*this));
}

}  // namespace lockstep
