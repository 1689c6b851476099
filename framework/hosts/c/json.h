// SPDX-License-Identifier: BSD-3-Clause
// Errors, findings and registries as JSON.
#pragma once

#include <string>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include <lockstep/finding.h>

namespace lockstep {
class Registry;
}

namespace lockstep::c {

/// The text; bytes that are not UTF-8, as files and hosts may give, are replaced.
std::string utf8(const std::string& text);
/// A number, or null if it is not finite.
Value number_or_null(double);
/// Sentence and data of an error; what finds no memory stays as it was.
void write_error(const Error&, int code, std::string& text, std::string& json) noexcept;
/// A finding; fields that do not apply are absent, as in the program's results.
Value value_of(const Finding&);
/// A list of objects with name and unit.
template <class Signals>
Value list_of(const Signals& signals) {
  Value::List all;
  for (const auto& s : signals) all.push_back(Value::object({{"name", s.name}, {"unit", s.unit}}));
  return all;
}
/// All types of a registry by shelf, with the fields of `lockstep list --json`.
Value types_of_registry(const Registry&);

}  // namespace lockstep::c
