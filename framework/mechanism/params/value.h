// A piece of a description as data: what a scene file says, or what C++ gives in its place. Every piece knows where it
// stood.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "framework/foundation/support/export.h"

namespace lockstep {

/// Where a value stood: line and column count from 1; line 0 = given in C++.
struct Where {
  std::shared_ptr<const std::string> file;
  int line = 0, column = 0;
  /// "four_bar.json:4:64", or "" for C++.
  LOCKSTEP_API std::string text() const;
};

/// null, true/false, number, text, list or object (its members in the order of the file).
class Value {
 public:
  struct Member;
  using List = std::vector<Value>;
  using Object = std::vector<Member>;

  // Out of line, as all that makes or ends a Value: Member is complete only below.
  LOCKSTEP_API Value();
  LOCKSTEP_API Value(bool b);          // NOLINT: a description reads like data
  LOCKSTEP_API Value(double x);        // NOLINT
  LOCKSTEP_API Value(int x);           // NOLINT
  LOCKSTEP_API Value(const char* s);   // NOLINT
  LOCKSTEP_API Value(std::string s);   // NOLINT
  LOCKSTEP_API Value(List items);      // NOLINT
  LOCKSTEP_API Value(Object members);  // NOLINT
  LOCKSTEP_API Value(const Value&);
  LOCKSTEP_API Value(Value&&) noexcept;
  LOCKSTEP_API Value& operator=(const Value&);
  LOCKSTEP_API Value& operator=(Value&&) noexcept;
  LOCKSTEP_API ~Value();
  LOCKSTEP_API static Value list(std::initializer_list<double> numbers);
  LOCKSTEP_API static Value object(std::initializer_list<std::pair<const char*, Value>> members);

  bool is_null() const { return std::holds_alternative<std::monostate>(data_); }
  const bool* boolean() const { return std::get_if<bool>(&data_); }
  const double* number() const { return std::get_if<double>(&data_); }
  const std::string* text() const { return std::get_if<std::string>(&data_); }
  const List* list() const { return std::get_if<List>(&data_); }
  const Object* object() const { return std::get_if<Object>(&data_); }
  List* list() { return std::get_if<List>(&data_); }
  Object* object() { return std::get_if<Object>(&data_); }

  /// Member of an object by name, nullptr when absent or when this is no object.
  LOCKSTEP_API const Value* find(std::string_view key) const;
  /// This object without the members named; what is no object stays as it is.
  LOCKSTEP_API Value without(std::initializer_list<std::string_view> keys) const;
  /// "a number", "a text", "a list of 3", ... for messages.
  LOCKSTEP_API std::string kind() const;

  Where where;

 private:
  std::variant<std::monostate, bool, double, std::string, List, Object> data_;
};

struct Value::Member {
  std::string key;
  Value value;
  Where where;  ///< of the key
};

}  // namespace lockstep
