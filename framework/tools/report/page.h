// SPDX-License-Identifier: BSD-3-Clause
// The page of a report, whose script and style are in the library, and the machine on which it is made.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <lockstep/report.h>
#include "framework/tools/report/numbers.h"

namespace lockstep::report {

/// Bytes of the page of a run, at most: its motion may have half of them, its columns have what the rest of the page leaves.
/// Meshes and bodies are kept, however many there are.
inline constexpr std::size_t kMostBytes = 20'000'000;
/// Bytes of numbers that so many letters of the page hold.
constexpr std::size_t bytes_in(std::size_t letters) { return letters / 4 * 3; }

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
