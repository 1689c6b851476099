// The logger by which the library speaks: warnings of a run, corrections of a start, plugins that are loaded.
#pragma once

#include <memory>
#include <string>

#include <lockstep/export.h>

namespace spdlog {
class logger;
}

namespace lockstep {

/// The logger "lockstep" of spdlog's registry. Where no host has registered one, it is made: warnings and errors to
/// standard error. To change its level, include <spdlog/spdlog.h>: logger()->set_level(spdlog::level::info).
LOCKSTEP_API std::shared_ptr<spdlog::logger> logger();

/// Puts another logger in its place, under the same name; nullptr silences the library.
LOCKSTEP_API void set_logger(std::shared_ptr<spdlog::logger>);

LOCKSTEP_API void log_warning(const std::string& text);
LOCKSTEP_API void log_info(const std::string& text);

}  // namespace lockstep
