#include "framework/tools/program/document.h"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

namespace lockstep {

void print_document(const nlohmann::ordered_json& j) {
  fmt::print("{}\n", j.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace lockstep
