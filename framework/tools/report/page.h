// SPDX-License-Identifier: BSD-3-Clause
// The page of a report, whose script and style are in the library, and the machine on which it is made.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <lockstep/report.h>
#include "framework/tools/report/numbers.h"

namespace lockstep::report {

/// The page without data, in pieces; made by the configuration from web/dist/report.html.
std::span<const std::string_view> page_pieces();

/// The page with its description, whose "text" has the title, and its numbers. Nothing in them ends an element of the
/// page.
LOCKSTEP_API std::string page_with(const nlohmann::ordered_json&, const Numbers&);

/// The texts of a report, with the version of the library.
nlohmann::ordered_json json_of(const ReportText&);

/// Writes a page; the file appears, or is replaced, when it is whole. Throws FileError.
LOCKSTEP_API void write_whole(const std::string& file, const std::string& page);

/// "Linux x86_64, Intel(R) Xeon(R) CPU @ 2.80GHz, 8 processors": system, processor as far as it is known, and how many.
std::string machine_words();
/// "lockstep 0.2.0, 2026-03-01, Linux x86_64, ...": version, today's date (UTC) and machine, for pictures of what was
/// measured.
LOCKSTEP_API std::string measured_words();

}  // namespace lockstep::report
