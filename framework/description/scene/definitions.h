// SPDX-License-Identifier: BSD-3-Clause
// The parameters and points of a scene, by name.
#pragma once

#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/math.h>
#include <lockstep/scene.h>
#include "framework/mechanism/expression/quantity.h"

namespace lockstep {

/// Whether it is a text that begins with "=".
inline bool is_formula(const Value& v) { return v.text() != nullptr && v.text()->starts_with('='); }

/// "parameters" and "points" of a scene, each computed when it is first read, and formulas of them. Formulas read places
/// of its bodies and markers too: "rod.at", the origin of body rod or of marker rod, "rod.from" and "rod.to", the ends
/// of a rod.
class Definitions {
 public:
  /// Of this root, which outlives the object. Throws SceneError for names that cannot be.
  explicit Definitions(const Value& root);

  /// Points, bodies and markers of a part, which outlives the object. Throws SceneError for names that cannot be.
  void add(const Value& part);

  /// The value of a name; nullptr if it has none. Throws SceneError: a faulty formula, a circle.
  const expression::Amount* find(const std::string& name);
  bool is_point(const std::string& name) const;
  std::vector<std::string> names(bool points_only) const;
  /// All with their values.
  std::vector<SceneParameter> all();

  /// The value of a formula under `context`. Throws SceneError.
  expression::Amount evaluate(const Value& formula, const std::string& context);

  /// The value with its formulas, at any depth, replaced by theirs.
  Value resolved(Value, const std::string& context);

  /// As a scene holds it, at this place of the file.
  static Value placed_value(const expression::Amount&, const SourceLocation&);

 private:
  struct Entry {
    std::string name;
    bool point;
    const Value* given;
    std::optional<expression::Amount> value{};
    std::string place{};           // of a body or marker: "at", "from", "to"
    std::exception_ptr refusal{};  // why it has no value
  };
  void take(const Value& root, const char* key, bool points);
  const expression::Amount& value(Entry&);
  expression::Amount given(const Value&, const std::string& context, bool point);
  void take_things(const Value& root, const char* list);
  Entry* place(const std::string& name);
  Vec3 place_of(const Entry&);
  Vec3 place_of_body(const Entry&);
  Vec3 vector_under(const Value& object, const std::string& key, const std::string& owner);
  Pose home_of(const std::string& body);

  std::vector<Entry> entries_;
  std::map<std::string, std::size_t> index_;
  std::map<std::string, const Value*> things_;  // bodies and markers
  std::map<std::string, Entry> places_;         // of these, that were read
  std::vector<const Entry*> open_;              // those that are being computed
};

}  // namespace lockstep
