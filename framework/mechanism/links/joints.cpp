// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/joints.h>

#include <lockstep/author/params.h>

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

}  // namespace lockstep
