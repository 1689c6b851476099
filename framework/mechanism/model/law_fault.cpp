#include "framework/mechanism/model/law_fault.h"

#include "framework/foundation/support/text.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

std::string shown(const LawName& law) {
  return law.type().empty() ? "" : " ('" + law.type() + "'" + of_plugin(law.origin()) + ")";
}

template <class Law, class Numbers>
std::string fault(const std::string& what, const Law& law, double t, Numbers&& numbers_of) {
  try {
    const VecX x = numbers_of(law.at(t));
    if (x.allFinite()) return {};
    std::string words;
    for (const double number : x) words += (words.empty() ? "" : ", ") + brief(number);
    return what + shown(law) + " gives " + words;
  } catch (...) {
    return what + shown(law) + " threw: " + thrown_words(std::current_exception());
  }
}

}  // namespace

std::string of_plugin(const std::string& origin) {
  return origin.empty() || origin == "built in" ? "" : " of plugin " + origin;
}

std::string law_fault(const std::string& what, const MotionLaw& law, double t) {
  return fault(what, law, t, [](const LawValue& l) { return VecX(Vec3(l.y, l.yd, l.ydd)); });
}

std::string law_fault(const std::string& what, const TranslationLaw& law, double t) {
  return fault(what, law, t, [](const TranslationValue& l) {
    VecX x(9);
    x << l.x, l.v, l.a;
    return x;
  });
}

std::string law_fault(const std::string& what, const RotationLaw& law, double t) {
  return fault(what, law, t, [](const RotationValue& l) {
    VecX x(10);
    x << l.q.coefficients(), l.w, l.a;
    return x;
  });
}

std::string marker_fault(const Marker& m, double t) {
  std::string words;
  if (m.slide) words = law_fault("the sliding law of marker '" + m.name + "'", *m.slide, t);
  if (words.empty() && m.spin) words = law_fault("the turning law of marker '" + m.name + "'", *m.spin, t);
  return words;
}

}  // namespace lockstep
