// SPDX-License-Identifier: BSD-3-Clause
// The page of a report; its script and style are in the library.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include <lockstep/report.h>

namespace lockstep::report {

/// The page without data, in pieces; made by the configuration from web/dist/report.html.
std::span<const std::string_view> page_pieces();

/// The page with its title, its description as JSON text, and its numbers as base64. Nothing in them ends an element of
/// the page.
LOCKSTEP_API std::string page_with(const std::string& title, const std::string& json, const std::string& numbers);

/// The texts of a report, with the version of the library.
nlohmann::ordered_json json_of(const ReportText&);

/// Writes a page; the file appears, or is replaced, when it is whole. Throws FileError.
void write_whole(const std::string& file, const std::string& page);

}  // namespace lockstep::report
