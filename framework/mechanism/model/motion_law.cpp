// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/law.h>

#include <utility>

namespace lockstep {
namespace {

// The deleter of a labelled pointer: keeps the law and its label as long as the pointer lives.
template <class L>
struct Keeper {
  LawPtr<L> law;
  LawLabel label;
  void operator()(const L*) { law.reset(); }
};

template <class L>
LawPtr<L> keep(const LawPtr<L>& law, LawLabel label) {
  return LawPtr<L>(law.get(), Keeper<L>{law, std::move(label)});
}

template <class L>
const LawLabel* kept(const LawPtr<L>& law) {
  const auto* keeper = std::get_deleter<Keeper<L>>(law);
  return keeper == nullptr ? nullptr : &keeper->label;
}

}  // namespace

MotionLaw::~MotionLaw() = default;
TranslationLaw::~TranslationLaw() = default;
RotationLaw::~RotationLaw() = default;

LawPtr<MotionLaw> labelled(const LawPtr<MotionLaw>& law, LawLabel label) { return keep(law, std::move(label)); }
LawPtr<TranslationLaw> labelled(const LawPtr<TranslationLaw>& law, LawLabel label) {
  return keep(law, std::move(label));
}
LawPtr<RotationLaw> labelled(const LawPtr<RotationLaw>& law, LawLabel label) { return keep(law, std::move(label)); }

const LawLabel* label_of(const LawPtr<MotionLaw>& law) { return kept(law); }
const LawLabel* label_of(const LawPtr<TranslationLaw>& law) { return kept(law); }
const LawLabel* label_of(const LawPtr<RotationLaw>& law) { return kept(law); }

}  // namespace lockstep
