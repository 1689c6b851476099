// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/joints.h>

namespace lockstep {

Universal::Universal(std::string name, Marker& p, Marker& s) : PhiLock(std::move(name), p, s, Mask::xyz, Cross{}) {}

TypeInfo Universal::info() {
  return {"universal", "Hooke's joint, origins coincide; free: turning about x of S and about y of P", {}};
}

std::unique_ptr<Lock> Universal::make(const Attachment& attachment, const Params&) {
  return std::make_unique<Universal>(attachment.name, attachment.p(), attachment.s());
}

template class PhiLock<Cross>;

}  // namespace lockstep
