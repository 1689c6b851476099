// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/json.h"

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/iterator/transform_iterator.hpp>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>

#include <lockstep/error.h>
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

using ParseError = nlohmann::detail::exception;
constexpr int kOutOfRange = 406;  // nlohmann's id of a number that no double holds

bool begins_with_word(std::string_view text, std::string_view word) {
  const bool sign = text.starts_with('-') || text.starts_with('+');
  return boost::istarts_with(text.substr(sign ? 1 : 0), word, std::locale::classic());
}

// Builds the tree from nlohmann's events. Each event is one token that ends where the parser has read to; the next one
// begins after it and any spaces, commas and colons.
class TreeBuilder {
 public:
  TreeBuilder(const std::string& text, const std::string& file)
      : text_(text), file_(std::make_shared<const std::string>(file)) {
    if (text_.starts_with("\xEF\xBB\xBF")) end_ = counted_ = 3;  // a byte order mark
  }

  // The parser looks at each character once.
  bool parse() {
    const auto count = [this](char c) { return ++read_, c; };
    return nlohmann::json::sax_parse(boost::make_transform_iterator(text_.begin(), count),
                                     boost::make_transform_iterator(text_.end(), count), this,
                                     nlohmann::json::input_format_t::json, true, true);
  }

  bool null() { return put(Value(), here()); }
  bool boolean(bool b) { return put(Value(b), here()); }
  bool number_integer(std::int64_t) { return number_as_written(); }
  bool number_unsigned(std::uint64_t) { return number_as_written(); }
  bool number_float(double, const std::string&) { return number_as_written(); }
  bool string(std::string& s) { return put(Value(std::move(s)), here()); }
  bool binary(nlohmann::json::binary_t&) { return false; }  // does not occur in JSON text
  bool start_object(std::size_t) { return open(Value(Value::Object{})); }
  bool start_array(std::size_t) { return open(Value(Value::List{})); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    open_.back().key = {std::move(name), Value(), here()};
    return done(Last::key);
  }

  bool parse_error(std::size_t position, const std::string&, const ParseError& error) {
    // The bad token begins after the last good one and at most one comma or colon, and not after the parser's position.
    const std::size_t byte = std::max(end_, std::min(begin(), std::max<std::size_t>(position, 1) - 1));
    refuse(at(byte), "", syntax_problem(byte, error));
  }

  Value take() { return std::move(root_); }

 private:
  enum class Last { nothing, opening, key, value };
  struct Level {
    Value value;
    Value::Member key;
  };

  // Line and column of a byte, which is at or after the last one asked for.
  SourceLocation at(std::size_t byte) {
    for (; counted_ < byte && counted_ < text_.size(); ++counted_) {
      const auto c = static_cast<unsigned char>(text_[counted_]);
      if (c == '\n')
        ++line_, column_ = 1;
      else if ((c & 0xC0) != 0x80)  // a byte that continues a character does not count
        ++column_;
    }
    return {file_, line_, column_};
  }
  // Behind the last good token: after spaces, and at most one comma or colon.
  std::size_t begin() const {
    const std::size_t byte = behind_spaces(end_);
    const bool mark = byte < text_.size() && (text_[byte] == ',' || text_[byte] == ':');
    return mark ? behind_spaces(byte + 1) : byte;
  }
  SourceLocation here() { return at(begin()); }
  bool done(Last last) {
    last_ = last;
    end_ = read_;
    return true;
  }

  // As written, whatever the locale. The parser knows the end of a number only by the character after it.
  bool number_as_written() {
    const std::size_t from = begin();
    double x = 0;  // remains where the number is too small for a double; one too large does not get here
    const auto [end, error] = std::from_chars(text_.data() + from, text_.data() + text_.size(), x);
    put(Value(x), at(from));
    end_ = end - text_.data();
    return true;
  }
  bool put(Value v, SourceLocation where) {
    v.where = std::move(where);
    if (open_.empty()) {
      root_ = std::move(v);
    } else if (Value::List* items = open_.back().value.list()) {
      items->push_back(std::move(v));
    } else {
      open_.back().key.value = std::move(v);
      open_.back().value.object()->push_back(std::move(open_.back().key));
    }
    return done(Last::value);
  }
  bool open(Value v) {
    v.where = here();
    if (open_.size() == kMostDepth)
      refuse(v.where, "",
             "objects and lists are nested deeper than " + std::to_string(kMostDepth) + " levels; flatten this one");
    open_.push_back({std::move(v), {}});
    return done(Last::opening);
  }
  bool close() {
    Value whole = std::move(open_.back().value);
    open_.pop_back();
    if (whole.object() != nullptr) check_keys(*whole.object());
    SourceLocation where = whole.where;
    return put(std::move(whole), std::move(where));
  }
  static void check_keys(const Value::Object& members) {
    std::vector<std::pair<std::string_view, const Value::Member*>> sorted;
    for (const Value::Member& m : members) sorted.emplace_back(m.key, &m);
    std::ranges::sort(sorted);
    const auto twice = std::ranges::adjacent_find(sorted, {}, [](const auto& m) { return m.first; });
    if (twice == sorted.end()) return;
    refuse(twice[1].second->where, "",
           "key \"" + twice[1].second->key + "\" is given twice in this object, first at " +
               twice->second->where.text() + "; remove one of the two");
  }

  std::size_t behind_spaces(std::size_t byte) const {
    for (;;) {
      byte = std::min(text_.find_first_not_of(" \t\n\r", byte), text_.size());
      const std::string_view rest = std::string_view(text_).substr(byte);
      const bool line = rest.starts_with("//");
      if (!line && !rest.starts_with("/*")) return byte;
      const std::size_t end = rest.find(line ? "\n" : "*/", 2);
      if (end == std::string_view::npos && !line) return byte;  // a comment without an end
      byte = end == std::string_view::npos ? text_.size() : byte + end + (line ? 1 : 2);
    }
  }
  // Describes what the parser found at `byte`, after the last good token.
  std::string syntax_problem(std::size_t byte, const ParseError& error) const {
    const std::string_view rest = std::string_view(text_).substr(byte);
    if (error.id == kOutOfRange)
      return "the number " +
             text_.substr(byte, std::min<std::size_t>(40, text_.find_first_of(" \t\r\n,]}", byte) - byte)) +
             " is beyond the range of numbers (1e308); write a smaller number";
    if (rest.empty()) {
      if (open_.empty()) return "the text is empty; a JSON object is expected";
      const Value& v = open_.back().value;
      return std::string("the text ends inside the ") + (v.object() ? "object" : "list") + " that begins at " +
             v.where.text() + "; a closing " + (v.object() ? "}" : "]") + " is missing";
    }
    if (begins_with_word(rest, "nan") || begins_with_word(rest, "inf"))
      return "NaN and infinity are not allowed; write a finite number";
    if (rest.front() == '/' || rest.front() == '#') return "this is no comment; write \"// ...\" or \"/* ... */\"";
    if (rest.front() == '\'') return "texts need double quotes; write \"...\"";
    if (rest.front() == '+' || rest.front() == '.')
      return "a number begins with a digit or with a minus sign; write 0.5 for .5, and no plus sign";
    const std::size_t mark = behind_spaces(end_);  // perhaps a comma or a colon
    const bool comma = mark < byte && text_[mark] == ',', colon = mark < byte && text_[mark] == ':';
    if (comma && (rest.front() == '}' || rest.front() == ']'))
      return std::string("there is a comma before the closing ") + rest.front() + "; remove it";
    if (open_.empty() && last_ != Last::nothing) return "there is text after the end of the scene; remove it";
    if (!open_.empty()) {
      const bool object = open_.back().value.object() != nullptr;
      if (last_ == Last::key && !colon) return "a colon is missing between the key and its value";
      if (last_ == Last::value && !comma) return "a comma is missing before this, or a closing bracket";
      const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
      if (object && last_ == Last::value && comma && end_ > 0 && is_digit(text_[end_ - 1]) && is_digit(rest.front()))
        return "the decimal separator of a number is a point, not a comma; write 0.6 for 0,6";
      if (object && last_ != Last::key) return "expected a key in double quotes";
    }
    const std::string_view what =
        error.what();  // "[...] parse error at line 1, column 2: ...", of which the place is dropped
    if (what.find("control character U+000A") != std::string_view::npos)
      return "a text has no closing quotation mark on its line; add it";
    const std::size_t words = what.find(": ");
    return "invalid JSON: " + std::string(words == std::string_view::npos ? what : what.substr(words + 2));
  }

  const std::string& text_;
  std::shared_ptr<const std::string> file_;
  std::size_t read_ = 0, end_ = 0;  // by the parser; end of the last good token
  Last last_ = Last::nothing;
  std::size_t counted_ = 0;
  int line_ = 1, column_ = 1;
  std::vector<Level> open_;
  Value root_;
};

}  // namespace

Value read_json(const std::string& text, const std::string& file_name) {
  if (text.size() > kMostBytes) {
    const SourceLocation where{std::make_shared<const std::string>(file_name), 0, 0};
    refuse(where, "",
           "the text has " + std::to_string(text.size()) + " bytes, the limit is " + std::to_string(kMostBytes) +
               " bytes; put large tables into CSV files");
  }
  TreeBuilder builder(text, file_name);
  builder.parse();
  return builder.take();
}

Value read_json_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_directory(path, error)) throw FileError("cannot read '" + path + "': it is a folder; name a file in it");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file && errno == ENOMEM) throw std::bad_alloc();
  if (!file)
    throw FileError("cannot read '" + path + "': " + std::generic_category().message(errno) + "; check the path");
  std::string text;
  std::string block(65536, '\0');
  while (file && text.size() <= kMostBytes) {  // one block beyond the limit is enough for read_json to refuse
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block, 0, static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) throw FileError("cannot read '" + path + "' to its end: " + std::generic_category().message(errno));
  return read_json(text, path);
}

}  // namespace lockstep
