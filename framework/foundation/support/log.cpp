// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/log.h>

#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace lockstep {
namespace {

constexpr const char* kName = "lockstep";

}  // namespace

std::shared_ptr<spdlog::logger> logger() {
  if (auto known = spdlog::get(kName)) return known;
  const auto fresh = std::make_shared<spdlog::logger>(kName, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  fresh->set_pattern("lockstep: %l: %v");
  fresh->set_level(spdlog::level::warn);
  try {
    spdlog::register_logger(fresh);
  } catch (const spdlog::spdlog_ex&) {  // another thread registered it first
    if (auto known = spdlog::get(kName)) return known;
  }
  return fresh;
}

void set_logger(std::shared_ptr<spdlog::logger> other) {
  if (!other) other = std::make_shared<spdlog::logger>(kName, std::make_shared<spdlog::sinks::null_sink_mt>());
  if (other->name() != kName) other = other->clone(kName);
  spdlog::drop(kName);
  spdlog::register_logger(std::move(other));
}

void log_warning(const std::string& text) { logger()->warn(text); }
void log_info(const std::string& text) { logger()->info(text); }

}  // namespace lockstep
