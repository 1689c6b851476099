// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/body.h>

#include <vector>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

template <class L>
std::string shown(const LawPtr<L>& law) {
  const LawLabel* label = label_of(law);
  return label == nullptr ? "" : " ('" + label->type + "'" + of_plugin(label->origin) + ")";
}

template <class L, class Numbers>
std::string fault(const std::string& what, const LawPtr<L>& law, double t, Numbers&& numbers_of) {
  if (!law) return {};
  try {
    std::vector<double> times;
    law->breakpoints(t, t + 1, times);
    const VecX x = numbers_of(law->at(t));
    if (x.allFinite()) return {};
    constexpr const char* kNames[] = {"y = ", "yd = ", "ydd = "};  // of a scalar law
    std::string words;
    for (int i = 0; i < x.size(); ++i)
      words += (i > 0 ? ", " : "") + std::string(x.size() == 3 ? kNames[i] : "") + text::brief(x[i]);
    return what + shown(law) + " gives " + words;
  } catch (...) {
    const LawLabel* label = label_of(law);
    return what + shown(law) + (label != nullptr && label->origin == "built in" ? ": " : " threw: ") +
           thrown_words(std::current_exception());
  }
}

}  // namespace

std::string law_fault(const std::string& what, const LawPtr<MotionLaw>& law, double t) {
  return fault(what, law, t, [](const LawValue& l) { return VecX(Vec3(l.y, l.yd, l.ydd)); });
}

std::string law_fault(const std::string& what, const LawPtr<TranslationLaw>& law, double t) {
  return fault(what, law, t, [](const TranslationValue& l) { return VecX((VecX(9) << l.x, l.v, l.a).finished()); });
}

std::string law_fault(const std::string& what, const LawPtr<RotationLaw>& law, double t) {
  return fault(what, law, t,
               [](const RotationValue& l) { return VecX((VecX(10) << l.q.coefficients(), l.w, l.a).finished()); });
}

std::string marker_fault(const Marker& m, double t) {
  const std::string words = law_fault("the translation law of marker '" + m.name + "'", m.translation_law, t);
  return words.empty() ? law_fault("the rotation law of marker '" + m.name + "'", m.rotation_law, t) : words;
}

}  // namespace lockstep
