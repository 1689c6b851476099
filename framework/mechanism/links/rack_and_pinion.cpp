// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/couplings.h>

#include <lockstep/author/params.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/checks.h"
#include "framework/mechanism/links/gear_functions.h"

namespace lockstep {
namespace {

double checked_radius(const std::string& link, double radius) {
  return checked(link, "radius", radius, radius != 0, " m; the radius of a pinion must not be zero");
}

}  // namespace

RollingRack::RollingRack(std::string name, Marker& p, Marker& s, double radius)
    : FunctionLock(name, p, s, Mask::y | Mask::z | Mask::e1 | Mask::e2,
                   rows_of(RollingPinion({checked_radius(name, radius)}))) {}

RackAndPinion::RackAndPinion(const CoupledPairs& pairs, double radius)
    : FunctionCoupling(pairs, rows_of(PinionAndSlide({checked_radius(pairs.name, radius)}))) {}

TypeInfo RackAndPinion::info() {
  return {
      "rack_and_pinion",
      "one pair: P, a pinion about z, rolls along x of S; two: pinion (rotates about z) and rack (moves along z)",
      {{"radius", Form::number, Unit::length, kRequired, "radius of the pitch circle; negative reverses the sense"}}};
}

std::unique_ptr<Lock> RackAndPinion::make(const Attachment& attachment, const Params& p) {
  if (attachment.pairs.size() < 2)
    return std::make_unique<RollingRack>(attachment.name, attachment.p(), attachment.s(), p.number("radius"));
  return std::make_unique<RackAndPinion>(attachment, p.number("radius"));
}

}  // namespace lockstep
