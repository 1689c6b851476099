// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/joints.h>

#include <lockstep/author/params.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/checks.h"
#include "framework/mechanism/links/joint_functions.h"

namespace lockstep {
namespace {

double distance_at_start(const Marker& p, const Marker& s) {
  return ((p.body->home * p.local).x - (s.body->home * s.local).x).norm();
}

}  // namespace

Distance::Distance(std::string name, Marker& p, Marker& s, double length)
    : FunctionLock(std::move(name), p, s, Mask::none, rows_of(DistanceFunction({}, length))) {}

Distance::Distance(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> length)
    : FunctionLock(name, p, s, Mask::none,
                   rows_of(DistanceFunction(given(name, std::move(length), "law for its length"), 0))) {}

Distance::Distance(std::string name, Marker& p, Marker& s) : Distance(std::move(name), p, s, distance_at_start(p, s)) {}

RowPlan Distance::plan_rows() {
  RowPlan plan = FunctionLock::plan_rows();
  const double length = phi_of<DistanceFunction>(function()).length_at(0.0);
  if (!(length > 0))
    throw ModelError("joint '" + name() + "': length " + text::brief(length) +
                     " m at t = 0; a distance must be above zero (two points that coincide are a spherical joint)");
  if (distance_at_start(p(), s()) == 0)
    throw ModelError("joint '" + name() + "': '" + p().name + "' and '" + s().name +
                     "' start at the same point, so the distance has no direction; move one of them");
  return plan;
}

TypeInfo Distance::info() {
  return {"distance",
          "distance between P and S, constant or by a law; degrees of freedom left: all but the distance",
          {{"length", Form::law, Unit::length, kOptional, "distance, m: a number or a law; default: as at the start"}}};
}

std::unique_ptr<Lock> Distance::make(const Attachment& attachment, const Params& params) {
  if (!params.has("length")) return std::make_unique<Distance>(attachment.name, attachment.p(), attachment.s());
  return std::make_unique<Distance>(attachment.name, attachment.p(), attachment.s(), params.law("length"));
}

}  // namespace lockstep
