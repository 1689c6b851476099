// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include <lockstep/text.h>
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

constexpr std::size_t kLineWidth = 100;

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_plain(const Value& v, std::string& out) {
  if (v.is_null()) out += "null";
  if (const bool* b = v.boolean()) out += *b ? "true" : "false";
  if (const std::string* s = v.text()) out += quoted(*s);
  if (const double* x = v.number()) {
    if (!std::isfinite(*x))
      refuse(v.where, "", "the number is " + text::number(*x) + ", which JSON cannot hold; give a finite one");
    out += text::number(*x);
  }
}

bool is_plain(const Value& v) { return v.list() == nullptr && v.object() == nullptr; }

// A list of plain values in one line, or "" if it is not such a list or too long.
std::string one_line(const Value::List& items) {
  std::string line = "[";
  for (const Value& item : items) {
    if (!is_plain(item)) return {};
    if (line.size() > 1) line += ", ";
    write_plain(item, line);
    if (line.size() > kLineWidth) return {};
  }
  return line + "]";
}

// With `margin` in lines, which begin so; without one in a single line.
void write(const Value& v, const std::string* margin, std::string& out) {
  const Value::List* items = v.list();
  if (is_plain(v)) return write_plain(v, out);
  const std::string line = margin != nullptr && items != nullptr ? one_line(*items) : "";
  if (!line.empty()) return void(out += line);
  const std::string deeper = margin != nullptr ? *margin + "  " : "", begin = margin != nullptr ? "\n" + deeper : "";
  const std::string between = margin != nullptr ? "," + begin : ", ";
  bool first = true;
  out += items != nullptr ? '[' : '{';
  for_each_child(v, [&](const Value& each, const std::string& key) {
    out += std::exchange(first, false) ? begin : between;
    if (items == nullptr) out += quoted(key) + ": ";
    write(each, margin != nullptr ? &deeper : nullptr, out);
  });
  if (margin != nullptr && !first) out += "\n" + *margin;
  out += items != nullptr ? ']' : '}';
}

}  // namespace

std::string write_json(const Value& v) {
  std::string out;
  const std::string margin;
  write(v, &margin, out);
  return out + "\n";
}

std::string write_json_line(const Value& value) {
  std::string out;
  write(value, nullptr, out);
  return out;
}

}  // namespace lockstep
