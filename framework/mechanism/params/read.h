// SPDX-License-Identifier: BSD-3-Clause
// Readers of one Value by its form, with errors that have its place. Params and the scene builder use them.
#pragma once

#include <charconv>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include <lockstep/math.h>

namespace lockstep {

/// Throws SceneError "file:line:column: context: problem" (empty parts are left out), with that place in its data.
[[noreturn]] LOCKSTEP_API void refuse(const SourceLocation&, const std::string& context, const std::string& problem,
                                      ErrorData about = {});

/// Runs f; a ModelError becomes a SceneError at `where`, with `context` before its message.
template <class F>
decltype(auto) placed(const SourceLocation& where, const std::string& context, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (const ModelError& error) {
    refuse(where, context, error.what(), static_cast<const ErrorData&>(error));
  }
}

/// A word of a command line as a value: true, false, a number, or a text.
LOCKSTEP_API Value read_word(const std::string&);

/// The number that all of a text is; nothing where it is none, or out of range.
template <class T>
std::optional<T> number_in(std::string_view text) {
  T x{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(x) : std::nullopt;
}

/// The parts of a text between marks; one where there is no mark.
LOCKSTEP_API std::vector<std::string> split_at(char mark, const std::string& text);
/// The same without blanks around them.
LOCKSTEP_API std::vector<std::string> words_at(char mark, const std::string& text);

/// A value as messages show it: `a text ("fast")`, `a number (2.5)`, "a list of 3".
LOCKSTEP_API std::string shown(const Value&);

/// The context of one item of a list: "joint 'A', points[2]".
inline std::string item(const std::string& context, std::size_t i) { return context + "[" + std::to_string(i) + "]"; }

/// Tables of keys; of two keys of one name the first counts.
using KeyTables = std::initializer_list<const Keys*>;
/// The first key of this name; nullptr where there is none.
LOCKSTEP_API const Key* key_in(KeyTables, std::string_view name);
/// Checks an object of this type against its keys, as Params does.
LOCKSTEP_API void check_members(const Value& object, const std::string& type, KeyTables, const std::string& owner);

// All throw SceneError by `refuse`; `context` names what is read: "joint 'A', law.slope".
// Numbers are finite and in SI; with a unit other than Unit::none a number may be a text such as "12 mm".
LOCKSTEP_API double read_number(const Value&, Unit, const std::string& context);
LOCKSTEP_API int read_integer(const Value&, const std::string& context);
LOCKSTEP_API bool read_boolean(const Value&, const std::string& context);
LOCKSTEP_API std::string read_text(const Value&, const std::string& context);
LOCKSTEP_API std::string read_choice(const Value&, std::span<const std::string> choices, const std::string& context);
LOCKSTEP_API Vec3 read_vector3(const Value&, Unit, const std::string& context);
LOCKSTEP_API std::vector<double> read_numbers(const Value&, Unit, const std::string& context);
LOCKSTEP_API std::vector<std::vector<double>> read_points(const Value&, Unit, const std::string& context);

/// Nine numbers as three rows of three.
LOCKSTEP_API Mat3 read_matrix3(const Value&, Unit, const std::string& context);

/// A direction of length 1: "x", "-y", "+z" or [x, y, z], not zero.
LOCKSTEP_API Vec3 read_axis(const Value&, const std::string& context);

/// A unit quaternion, from one of: [w, x, y, z] (of length 1 but for a tenth); {"axis": direction, "angle": angle};
/// {"angles": [a, b, c], "sequence": "xyz" or a name that angle_sequence() knows}; {"matrix": three rows} (axes of the
/// frame as columns); two of {"x": direction, "y": ..., "z": ...}, at right angles to 1e-3: the alphabetically first is
/// kept, the other made perpendicular to it.
LOCKSTEP_API Quat read_orientation(const Value&, const std::string& context);
/// The same, which warns of a quaternion that is off length 1 by more than rounding leaves.
LOCKSTEP_API Quat read_orientation_told(const Value&, const std::string& context);

}  // namespace lockstep
