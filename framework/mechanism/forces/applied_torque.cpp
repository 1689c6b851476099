#include "framework/mechanism/forces/applied_torque.h"

#include "framework/mechanism/forces/variation.h"

namespace lockstep {
namespace {
AppliedVector vector_of(AppliedTorque::Options o) {
  return {o.torque, std::move(o.law), o.direction, std::move(o.laws), o.axes};
}
}  // namespace

AppliedTorque::AppliedTorque(std::string name, Marker& p, Options options)
    : Applied(std::move(name), p, nullptr, vector_of(std::move(options)), "torque") {}
AppliedTorque::AppliedTorque(std::string name, Marker& p, Marker& s, Options options)
    : Applied(std::move(name), p, &s, vector_of(std::move(options)), "torque") {}

const TypeInfo& AppliedTorque::info() {
  static const TypeInfo info{"applied_torque", "torque on p's body; with s, the opposite on s's body",
                             keys("torque", Unit::torque)};
  return info;
}

std::unique_ptr<Force> AppliedTorque::make(const Site& site, const Params& k) {
  AppliedVector v = read(k, "torque");
  const Options o{v.value, std::move(v.law), v.direction, std::move(v.laws), v.axes};
  if (!has_s(site)) return std::make_unique<AppliedTorque>(site.name, p_of(site, k), o);
  return std::make_unique<AppliedTorque>(site.name, p_of(site, k), s_of(site, k), o);
}

void AppliedTorque::setup() {
  require_turning(p(), "turns");
  if (s() != nullptr) require_turning(*s(), "turns");
  Applied::setup();
}

void AppliedTorque::apply(const Inputs& in, WrenchSum& out) const {
  const Vec3 M = in_world_axes(in);
  out.torque(P_.slot, M);
  if (s() != nullptr) out.torque(S_.slot, -M);
}

void AppliedTorque::tangent(const Inputs& in, TangentSum& out) const {
  const Variation at(in, P_, S_);
  const VaryingVector M = varying(in, at);
  at.torque(0, M, out);
  if (s() != nullptr) at.torque(1, -M, out);
}

std::vector<Quantity> AppliedTorque::quantities() const {
  return {
      {"torque_on_p_world_x", "N m"}, {"torque_on_p_world_y", "N m"}, {"torque_on_p_world_z", "N m"}, {"power", "W"}};
}

double AppliedTorque::quantity(int k, const Inputs& in) const {
  const Vec3 M = in_world_axes(in);
  if (k < 3) return M[k];
  return M.dot(turn_rate(in, P_.slot) - turn_rate(in, S_.slot));
}

double AppliedTorque::supply(const Inputs& in) const { return quantity(3, in); }

}  // namespace lockstep
