#include "framework/mechanism/forces/applied_force.h"

#include "framework/mechanism/forces/variation.h"

namespace lockstep {
namespace {
AppliedVector vector_of(AppliedForce::Options o) {
  return {o.force, std::move(o.law), o.direction, std::move(o.laws), o.axes};
}
}  // namespace

AppliedForce::AppliedForce(std::string name, Marker& p, Options options)
    : Applied(std::move(name), p, nullptr, vector_of(std::move(options)), "force") {}
AppliedForce::AppliedForce(std::string name, Marker& p, Marker& s, Options options)
    : Applied(std::move(name), p, &s, vector_of(std::move(options)), "force") {}

const TypeInfo& AppliedForce::info() {
  static const TypeInfo info{"applied_force",
                             "force at the origin of p on p's body; with s, the opposite on s's body at the same point",
                             keys("force", Unit::force)};
  return info;
}

std::unique_ptr<Force> AppliedForce::make(const Site& site, const Params& k) {
  AppliedVector v = read(k, "force");
  const Options o{v.value, std::move(v.law), v.direction, std::move(v.laws), v.axes};
  if (!has_s(site)) return std::make_unique<AppliedForce>(site.name, p_of(site, k), o);
  return std::make_unique<AppliedForce>(site.name, p_of(site, k), s_of(site, k), o);
}

void AppliedForce::setup() {
  if (s() != nullptr) require_turning(*s(), "puts a force with a lever arm on");
  Applied::setup();
}

void AppliedForce::apply(const Inputs& in, WrenchSum& out) const {
  const Vec3 F = in_world_axes(in), x = in_world(P_, in).x;
  out.force(P_.slot, F, x);
  if (s() != nullptr) out.force(S_.slot, -F, x);
}

void AppliedForce::tangent(const Inputs& in, TangentSum& out) const {
  const Variation at(in, P_, S_);
  const VaryingVector F = varying(in, at), x = at.point(0);
  at.force(0, F, x, out);
  if (s() != nullptr) at.force(1, -F, x, out);
}

double AppliedForce::potential(const Inputs& in) const {
  return S_.slot == kGround ? -constant().dot(in_world(P_, in).x) : 0.0;
}

std::vector<Quantity> AppliedForce::quantities() const {
  return {{"force_on_p_world_x", "N"}, {"force_on_p_world_y", "N"}, {"force_on_p_world_z", "N"}, {"power", "W"}};
}

double AppliedForce::quantity(int k, const Inputs& in) const {
  const Vec3 F = in_world_axes(in);
  if (k < 3) return F[k];
  const Vec3 x = in_world(P_, in).x;
  return F.dot(point_velocity(in, P_.slot, x) - point_velocity(in, S_.slot, x));
}

// The power, less what the potential of a constant world force tells already.
double AppliedForce::supply(const Inputs& in) const {
  const double power = quantity(3, in);
  return S_.slot == kGround ? power - constant().dot(in_world(P_, in).v) : power;
}

}  // namespace lockstep
