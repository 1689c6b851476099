// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/page.h"

#include <boost/algorithm/string/replace.hpp>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>

#include <lockstep/error.h>
#include <lockstep/version.h>

namespace lockstep::report {
namespace {

// Puts `value` in place of the one `mark` in the page.
void put(std::string& page, std::string_view mark, const std::string& value) {
  const std::size_t at = page.find(mark);
  if (at == std::string::npos) throw Error("the page of reports lacks its mark " + std::string(mark));
  page.replace(at, mark.size(), value);
}

}  // namespace

// From the end, so that no mark is found in what was put in. In JSON only texts hold "<".
std::string page_with(const nlohmann::ordered_json& json, const Numbers& numbers) {
  std::string page, title = json["text"]["title"];
  if (title.empty()) title = "lockstep report";
  for (const std::string_view piece : page_pieces()) page += piece;
  const std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  put(page, "@lockstep-numbers@", numbers.base64());
  put(page, "@lockstep-json@", boost::replace_all_copy(text, "<", "\\u003c"));
  put(page, "@lockstep-title@", boost::replace_all_copy(boost::replace_all_copy(title, "&", "&amp;"), "<", "&lt;"));
  return page;
}

nlohmann::ordered_json json_of(const ReportText& text) {
  std::vector<std::string> warnings;
  for (const Finding& f : text.findings)
    if (f.severity() != Severity::note) warnings.push_back(f.text());
  if (!text.failure.empty()) warnings.push_back(text.failure);
  return {{"title", text.title},       {"description", text.description},
          {"scene", text.scene},       {"command", text.command},
          {"facts", text.facts},       {"warnings", warnings},
          {"panels", text.panels},     {"channels", text.channels},
          {"marked", text.marked},     {"version", library_version()},
          {"machine", machine_words()}};
}

// The file appears when it is whole. A device or a pipe is written to, and never replaced.
void write_whole(const std::string& file, const std::string& page) {
  std::error_code error;
  const bool in_place = std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error);
  const std::string partial = in_place ? file : file + ".partial";
  error.clear();
  errno = 0;
  std::ofstream out(partial, std::ios::binary | std::ios::trunc);
  if (!out && errno == ENOMEM) throw std::bad_alloc();
  out << page;
  out.close();
  if (out && !in_place) std::filesystem::rename(partial, file, error);
  if (out && !error) return;
  std::error_code ignored;
  if (!in_place) std::filesystem::remove(partial, ignored);
  throw FileError("report '" + file + "' cannot be written" + (error ? ": " + error.message() : "") +
                  "; check the folder and the free space, or name another file");
}

}  // namespace lockstep::report
