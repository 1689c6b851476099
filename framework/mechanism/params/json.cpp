#include "framework/mechanism/params/json.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "framework/mechanism/params/read.h"
#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"

namespace lockstep {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Follows the parser through the text, token by token, and knows line and column of where it is.
class Cursor {
 public:
  explicit Cursor(const std::string& text) : text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = counted_ = 3;  // a byte order mark
  }
  std::size_t at() const { return at_; }

  // To the start of the next token; commas and colons are none.
  std::size_t next() {
    while (at_ < text_.size() && (is_space(text_[at_]) || text_[at_] == ',' || text_[at_] == ':')) ++at_;
    return at_;
  }
  void skip(std::size_t n) { at_ += n; }
  void skip_text() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    ++at_;
  }
  // A number, read as written: whatever the locale, its decimal sign is the point.
  void read_number(double& x) {
    const char* begin = text_.data() + at_;
    const char* end = begin;
    while (end < text_.data() + text_.size() &&
           std::string_view("+-.eE0123456789").find(*end) != std::string_view::npos)
      ++end;
    at_ += static_cast<std::size_t>(end - begin);
    std::from_chars(begin, end, x);
  }
  // Line and column of a byte at or behind the last one asked for.
  void locate(std::size_t byte, int& line, int& column) {
    for (; counted_ < byte && counted_ < text_.size(); ++counted_) {
      const auto c = static_cast<unsigned char>(text_[counted_]);
      if (c == '\n')
        ++line_, column_ = 1;
      else if ((c & 0xC0) != 0x80)  // a byte that continues a character counts nothing
        ++column_;
    }
    line = line_, column = column_;
  }

 private:
  const std::string& text_;
  std::size_t at_ = 0, counted_ = 0;
  int line_ = 1, column_ = 1;
};

bool begins_with_word(std::string_view text, std::string_view word) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  if (text.size() < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if ((text[i] | 0x20) != word[i]) return false;
  return true;
}

// Takes nlohmann's events and builds the tree. Each event is one token; the cursor steps along.
class Builder {
 public:
  Builder(const std::string& text, const std::string& file)
      : text_(text), file_(std::make_shared<const std::string>(file)), cursor_(text) {}

  bool null() { return scalar(Value(), 4); }
  bool boolean(bool b) { return scalar(Value(b), b ? 4 : 5); }
  bool number_integer(std::int64_t) { return number_as_written(); }
  bool number_unsigned(std::uint64_t) { return number_as_written(); }
  bool number_float(double, const std::string&) { return number_as_written(); }
  bool string(std::string& s) {
    const Where where = here();
    cursor_.skip_text();
    return put(Value(std::move(s)), where);
  }
  bool binary(nlohmann::json::binary_t&) { return false; }  // no such thing in JSON text
  bool start_object(std::size_t) { return open(Value(Value::Object{})); }
  bool start_array(std::size_t) { return open(Value(Value::List{})); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    const Where where = here();
    cursor_.skip_text();
    const auto [first, fresh] = open_.back().keys.try_emplace(name, where);
    if (!fresh) {
      refuse(where, "",
             "key \"" + name + "\" stands twice in this object, first at " + first->second.text() +
                 "; remove one of the two");
    }
    open_.back().key = {name, Value(), where};
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& error) {
    // The bad token begins behind the last good one and at most one comma or colon, and not behind the parser's
    // position.
    const std::size_t last = cursor_.at();
    std::size_t byte = behind_spaces(last);
    if (byte < text_.size() && (text_[byte] == ',' || text_[byte] == ':')) byte = behind_spaces(byte + 1);
    byte = std::max(last, std::min(byte, std::max<std::size_t>(position, 1) - 1));
    refuse(at(byte), "", syntax_problem(last, byte, error.what()));
  }

  Value take() { return std::move(root_); }

 private:
  struct Level {
    Value value;
    Value::Member key;
    std::unordered_map<std::string, Where> keys;
  };

  Where at(std::size_t byte) {
    Where where{file_, 1, 1};
    cursor_.locate(byte, where.line, where.column);
    return where;
  }
  Where here() { return at(cursor_.next()); }

  bool scalar(Value v, std::size_t length) {
    const Where where = here();
    cursor_.skip(length);
    return put(std::move(v), where);
  }
  bool number_as_written() {
    const Where where = here();
    double x = 0;  // stays when the number is too small for a double; one too large never comes here
    cursor_.read_number(x);
    return put(Value(x), where);
  }
  bool put(Value v, const Where& where) {
    v.where = where;
    if (open_.empty()) {
      root_ = std::move(v);
    } else if (Value::List* items = open_.back().value.list()) {
      items->push_back(std::move(v));
    } else {
      open_.back().key.value = std::move(v);
      open_.back().value.object()->push_back(std::move(open_.back().key));
    }
    return true;
  }
  bool open(Value v) {
    v.where = here();
    if (open_.size() == kMostDepth)
      refuse(v.where, "",
             "objects and lists are nested deeper than " + std::to_string(kMostDepth) +
                 "; the limit keeps readers safe, flatten this one");
    cursor_.skip(1);
    open_.push_back({std::move(v), {}, {}});
    return true;
  }
  bool close() {
    cursor_.next();
    cursor_.skip(1);
    Value done = std::move(open_.back().value);
    open_.pop_back();
    const Where where = done.where;
    return put(std::move(done), where);
  }

  std::size_t behind_spaces(std::size_t byte) const {
    while (byte < text_.size() && is_space(text_[byte])) ++byte;
    return byte;
  }
  // Plain words for what the parser found at `byte`, behind the last good token.
  std::string syntax_problem(std::size_t last, std::size_t byte, std::string what) const;

  const std::string& text_;
  std::shared_ptr<const std::string> file_;
  Cursor cursor_;
  std::vector<Level> open_;
  Value root_;
};

std::string Builder::syntax_problem(std::size_t last, std::size_t byte, std::string what) const {
  const std::string_view rest = std::string_view(text_).substr(byte);
  if (what.find("number overflow") != std::string::npos)
    return "the number " +
           text_.substr(byte, std::min<std::size_t>(40, text_.find_first_of(" \t\r\n,]}", byte) - byte)) +
           " is beyond the range of numbers (1e308); write a smaller one";
  if (rest.empty()) {
    if (open_.empty()) return "the text is empty; a JSON object is expected";
    const Value& v = open_.back().value;
    return std::string("the text ends inside the ") + (v.object() ? "object" : "list") + " that begins at " +
           v.where.text() + "; a closing " + (v.object() ? "}" : "]") + " is missing";
  }
  if (begins_with_word(rest, "nan") || begins_with_word(rest, "inf"))
    return "NaN and infinity are no numbers of JSON, and no quantity here may be one; write a finite number";
  if (rest.front() == '/' || rest.front() == '#') return "comments are not allowed in JSON; remove it";
  if (rest.front() == '\'') return "texts stand in double quotes; write \"...\"";
  if (rest.front() == '+' || rest.front() == '.')
    return "a number begins with a digit or with a minus sign; write 0.5 for .5, and no plus sign";
  const bool comma = text_.substr(last, byte - last).find(',') != std::string::npos;
  if (comma && (rest.front() == '}' || rest.front() == ']'))
    return std::string("a comma stands before the closing ") + rest.front() + "; remove it";
  if (open_.empty() && last > 0) return "something stands behind the end of the description; remove it";
  if (what.find("object key") != std::string::npos) return "expected a key in double quotes";
  if (what.find("expected ':'") != std::string::npos) return "a colon is missing between the key and its value";
  if (what.find("expected ']'") != std::string::npos || what.find("expected '}'") != std::string::npos)
    return "a comma is missing before this, or a closing bracket";
  if (const std::size_t from = what.find("column "); from != std::string::npos)
    if (const std::size_t colon = what.find(": ", from); colon != std::string::npos) what = what.substr(colon + 2);
  return "no valid JSON: " + what;
}

}  // namespace

Value read_json(const std::string& text, const std::string& file_name) {
  if (text.size() > kMostBytes) {
    const Where where{std::make_shared<const std::string>(file_name), 0, 0};
    refuse(where, "",
           "the text has " + std::to_string(text.size()) + " bytes, the limit is " + std::to_string(kMostBytes) +
               "; put large tables into CSV files");
  }
  Builder builder(text, file_name);
  nlohmann::json::sax_parse(text, &builder);
  return builder.take();
}

}  // namespace lockstep
