// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/lock.h>

#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/lock/add_differences.h"

namespace lockstep {

namespace {

[[noreturn]] void refuse(const Lock& link, const std::string& problem) {
  throw ModelError(
      "joint '" + link.name() + "' " + problem,
      {.thing = {.kind = "joint", .name = link.name(), .type = std::string(link.type()), .origin = link.origin()}});
}

}  // namespace

Lock::Lock(std::string name) : name_(std::move(name)) {}
Lock::~Lock() = default;

void Lock::set_unilateral(const Unilateral& u) {
  if (!(u.restitution >= 0 && u.restitution <= 1))
    refuse(*this, "is one-sided with restitution " + text::brief(u.restitution) + "; it must be between 0 and 1");
  if (!(u.rest_speed > 0) || !std::isfinite(u.rest_speed))
    refuse(*this, "is one-sided with rest_speed " + text::brief(u.rest_speed) +
                      "; it must be above zero, or bounces would never end");
  unilateral_ = std::make_unique<const Unilateral>(u);
}

const std::string& Lock::origin() const {
  static const std::string kNone;
  return origin_ ? *origin_ : kNone;
}

void Lock::set_origin(std::string origin) {
  origin_ = origin.empty() ? nullptr : std::make_unique<const std::string>(std::move(origin));
}

void Lock::share_rows(const Lock& with) {
  if (rows_ && with.rows_ && rows_ != with.rows_ && *rows_ == *with.rows_) rows_ = with.rows_;
}

void Lock::setup() {
  RowPlan plan = plan_rows();
  if (!rows_ || *rows_ != plan.rows) rows_ = std::make_shared<const std::vector<LinkRow>>(std::move(plan.rows));
  slots_ = plan.slots, pattern_ = plan.pattern, layout_ = plan.layout, sign_ = plan.sign;
  const std::string rows = std::to_string(row_count()) + " constraints; ";
  if (row_count() < 1 || row_count() > kMaxRows)
    refuse(*this,
           "has " + rows + "a joint has 1 to " + std::to_string(kMaxRows) + ": give it a mask, a drive or a function");
  if (unilateral_ && row_count() != 1)
    refuse(*this, "is one-sided and has " + rows +
                      "a one-sided joint has exactly one: use a joint of one constraint, such as stop, distance or "
                      "point_on_plane, or a lock with a mask of one word");
}

void Lock::set_indices(int number, int first_state, int first_memory) {
  number_ = number;
  first_state_ = first_state;
  first_memory_ = first_memory;
}

// ------------------------------------------------------------------------------------------------------------- tangent

void add_tangent(const Lock& link, const Inputs& in, std::span<const double> lambda, TangentSum& out) {
  if (const TangentFormula* formula = link.tangent_formula())
    formula->tangent(in, lambda, out);
  else
    difference_tangent(link, in, lambda, out);
}

void difference_tangent(const Lock& link, const Inputs& in, std::span<const double> lambda, TangentSum& out) {
  RowTable& scratch = out.differences(in).rows;
  const SlotList& on = link.slots();
  const std::span<const int> slots(on.slot.data(), static_cast<std::size_t>(on.n));
  add_differences(slots, false, in, out, [&](const Inputs& at, VecX& f) {  // -Jh^T lambda
    const RowBlock block = gather_alone(link, at, scratch);
    for (int i = 0; i < on.n; ++i)
      for (int k = 0; k < block.rows(); ++k) {
        const auto r = block.J(i, k);
        for (int j = 0; j < 6; ++j) f[6 * on[i] + j] -= lambda[k] * r[j];
      }
  });
}

bool axis_stays_in_plane(Axis axis, const Vec3& normal) {
  const Vec3 along = Vec3::Unit(axis_index(axis) % 3);
  return is_rotation(axis) ? are_parallel(along, normal) : are_perpendicular(along, normal);
}

}  // namespace lockstep
