// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/joints.h>

#include <lockstep/author/params.h>
#include <lockstep/body.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/checks.h"
#include "framework/mechanism/links/joint_functions.h"

namespace lockstep {

TypeInfo GenericLock::info() {
  return {"lock",
          "any of the 64 masks; degrees of freedom left: the coordinates not in the mask",
          {{"mask", Form::text, Unit::none, kRequired,
            "constraints in words: x y z (translations of P in S axes), e1 e2 e3 (rotations about x y z)"}}};
}

std::unique_ptr<Lock> GenericLock::make(const Attachment& attachment, const Params& params) {
  return std::make_unique<GenericLock>(attachment.name, attachment.p(), attachment.s(), mask_from(params.text("mask")));
}

Universal::Universal(std::string name, Marker& p, Marker& s)
    : FunctionLock(std::move(name), p, s, Mask::xyz, rows_of(Cross{})) {}

TypeInfo Universal::info() {
  return {"universal", "Hooke's joint; degrees of freedom left: rotation about x of S and y of P", {}};
}

std::unique_ptr<Lock> Universal::make(const Attachment& attachment, const Params&) {
  return std::make_unique<Universal>(attachment.name, attachment.p(), attachment.s());
}

Screw::Screw(std::string name, Marker& p, Marker& s, double lead, LawPtr<MotionLaw> slip)
    : FunctionLock(
          name, p, s, Mask::x | Mask::y | Mask::e1 | Mask::e2,
          rows_of(ScrewThread(checked(name, "lead", lead, true, " m; it must be a finite number"), std::move(slip)))) {}

std::vector<Quantity> Screw::quantities() const {
  return {{"angle", "rad", "rotation of P about S's z, with its revolutions"}, {"rate", "rad/s", "rate of the angle"}};
}

double Screw::quantity(int k, const Inputs& in) const {
  const Time angle = function().along_motion(in, memory(in))[0].angle_z();
  return k == 0 ? angle.v : angle.d;
}

TypeInfo Screw::info() {
  return {"screw",
          "nut on a thread about z of S; degrees of freedom left: rotation about z, coupled to translation along z",
          {{"lead", Form::number, Unit::length, kRequired, "advance per revolution, negative for a left-hand thread"},
           {"offset", Form::law, Unit::length, kOptional, "axial offset from the thread; default: none"}}};
}

std::unique_ptr<Lock> Screw::make(const Attachment& attachment, const Params& p) {
  return std::make_unique<Screw>(attachment.name, attachment.p(), attachment.s(), p.number("lead"),
                                 p.has("offset") ? p.law("offset") : LawPtr<MotionLaw>{});
}

}  // namespace lockstep
