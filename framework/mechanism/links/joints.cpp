#include "framework/mechanism/links/joints.h"

#include "framework/foundation/support/error.h"

namespace lockstep {

TypeInfo GenericLock::info() {
  return {"lock",
          "any of the 64 masks; free: the axes whose rows are not named",
          {{"mask", Form::text, Unit::none, kRequired,
            "rows in words: x y z (translations of P in S axes), e1 e2 e3 (turns about x y z)"}}};
}

std::unique_ptr<Lock> GenericLock::make(const Site& site, const Params& params) {
  Mask mask = Mask::none;
  try {
    mask = mask_from(params.text("mask"));
  } catch (const ModelError& e) {
    const std::string problem = e.what();  // "mask: unknown row ...": the key is named by refuse already
    params.refuse("mask", problem.substr(problem.find(": ") + 2));
  }
  return std::make_unique<GenericLock>(site.name, site.p(), site.s(), mask);
}

}  // namespace lockstep
