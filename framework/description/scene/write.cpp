#include "framework/description/scene/write.h"

#include <cmath>
#include <utility>

#include "framework/mechanism/params/read.h"
#include <lockstep/text.h>

namespace lockstep {
namespace {

constexpr std::size_t kLineWidth = 100;

void write_text(const std::string& s, std::string& out) {
  constexpr const char* kHex = "0123456789abcdef";
  out += '"';
  for (const char c : s) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (code < 0x20) {
      out += "\\u00";
      out += kHex[code >> 4];
      out += kHex[code & 15];
    } else {
      out += c;
    }
  }
  out += '"';
}

void write_plain(const Value& v, std::string& out) {
  if (v.is_null()) out += "null";
  if (const bool* b = v.boolean()) out += *b ? "true" : "false";
  if (const std::string* s = v.text()) write_text(*s, out);
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

void write(const Value& v, std::size_t depth, std::string& out) {
  const std::string margin(2 * depth, ' ');
  if (const Value::List* items = v.list()) {
    const std::string line = one_line(*items);
    if (!line.empty()) {
      out += line;
      return;
    }
    for (std::size_t i = 0; i < items->size(); ++i) {
      out += (i == 0 ? "[\n  " : ",\n  ") + margin;
      write((*items)[i], depth + 1, out);
    }
    out += "\n" + margin + "]";
  } else if (const Value::Object* members = v.object()) {
    for (std::size_t i = 0; i < members->size(); ++i) {
      out += (i == 0 ? "{\n  " : ",\n  ") + margin;
      write_text((*members)[i].key, out);
      out += ": ";
      write((*members)[i].value, depth + 1, out);
    }
    out += members->empty() ? "{}" : "\n" + margin + "}";
  } else {
    write_plain(v, out);
  }
}

}  // namespace

std::string write_json(const Value& v) {
  std::string out;
  write(v, 0, out);
  return out + "\n";
}

namespace {

void write_in_line(const Value& v, std::string& out) {
  const char* between = "";
  if (const Value::List* items = v.list()) {
    out += '[';
    for (const Value& item : *items) out += std::exchange(between, ", "), write_in_line(item, out);
    out += ']';
  } else if (const Value::Object* members = v.object()) {
    out += '{';
    for (const auto& member : *members) {
      out += std::exchange(between, ", ");
      write_text(member.key, out);
      out += ": ";
      write_in_line(member.value, out);
    }
    out += '}';
  } else {
    write_plain(v, out);
  }
}

}  // namespace

std::string write_json_line(const Value& value) {
  std::string out;
  write_in_line(value, out);
  return out;
}

}  // namespace lockstep
