#include "framework/tools/program/findings.h"

#include <algorithm>
#include <cmath>

namespace lockstep {

nlohmann::ordered_json findings_json(const std::vector<Finding>& findings) {
  auto all = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    nlohmann::ordered_json j = {{"severity", to_string(f.severity())}, {"code", f.code()}};
    const auto put = [&](const char* key, const std::string& text) {
      if (!text.empty()) j[key] = text;
    };
    const auto put_number = [&](const char* key, double x) {
      if (std::isfinite(x)) j[key] = x;
    };
    put("thing", f.thing), put("message", f.message), put("advice", f.advice);
    put_number("value", f.value), put_number("limit", f.limit), put("unit", f.unit);
    put_number("t", f.t), put("place", f.place);
    all.push_back(std::move(j));
  }
  return all;
}

Exit exit_code_of(const std::vector<Finding>& findings, bool strict) {
  const auto any = [&](Severity s) {
    return std::ranges::any_of(findings, [&](const Finding& f) { return f.severity() == s; });
  };
  if (any(Severity::wrong)) return kExitNotConserved;
  return strict && any(Severity::doubt) ? kExitDoubtful : kExitOk;
}

}  // namespace lockstep
