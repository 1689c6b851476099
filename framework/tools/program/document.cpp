// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/document.h"
#include "framework/tools/program/findings.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace lockstep {

void print_document(const nlohmann::ordered_json& j) {
  const std::string text = j.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  std::fwrite(text.data(), 1, text.size(), stdout);  // what is not taken is told at the end, by the exit code
}

void print_result(nlohmann::ordered_json j) {
  if (j.is_object()) j["findings"] = findings_json(CommandFindings::all());
  print_document(j);
}

nlohmann::ordered_json json_number(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

}  // namespace lockstep
