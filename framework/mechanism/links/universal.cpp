// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/joints.h>

#include <lockstep/author/params.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/joint_functions.h"

namespace lockstep {

Universal::Universal(std::string name, Marker& p, Marker& s)
    : FunctionLock(std::move(name), p, s, Mask::xyz, rows_of(Cross{})) {}

TypeInfo Universal::info() {
  return {"universal", "Hooke's joint; degrees of freedom left: rotation about x of S and y of P", {}};
}

std::unique_ptr<Lock> Universal::make(const Attachment& attachment, const Params&) {
  return std::make_unique<Universal>(attachment.name, attachment.p(), attachment.s());
}

}  // namespace lockstep
