// SPDX-License-Identifier: BSD-3-Clause
// The library's logger: warnings of a run, corrections of a start, plugins that are loaded.
#pragma once

#include <memory>
#include <string>

#include <lockstep/detail/export.h>

namespace spdlog {
class logger;
}

namespace lockstep {

/// The logger "lockstep" of spdlog's registry. When the host has registered none, one is made that writes warnings and
/// errors to standard error. To change its level, include <spdlog/spdlog.h>: logger()->set_level(spdlog::level::info).
LOCKSTEP_API std::shared_ptr<spdlog::logger> logger();

/// Replaces the logger, under the same name; nullptr silences the library.
LOCKSTEP_API void set_logger(std::shared_ptr<spdlog::logger>);

/// Logs `text` as a warning.
LOCKSTEP_API void log_warning(const std::string& text);
/// Logs `text` as information; hidden at the default level.
LOCKSTEP_API void log_info(const std::string& text);

}  // namespace lockstep
