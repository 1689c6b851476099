// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/error.h>

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

std::string place_words(const ErrorData& e) {
  if (e.line == 0) return e.file.empty() ? "" : e.file + ": ";
  const std::string at = std::to_string(e.line) + ":" + std::to_string(e.column) + ": ";
  return e.file.empty() ? at : e.file + ":" + at;
}

std::string sentence_of(const ErrorData& e) {
  std::string words = place_words(e) + at_time(e.t);
  if (e.thing.known()) words += e.thing.words() + ": ";
  if (!e.key.empty()) words += e.key + " ";
  words += e.problem;
  return e.advice.empty() ? words : words + "; " + e.advice;
}

// The first semicolon outside of parentheses.
std::size_t first_semicolon(std::string_view words) {
  int depth = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    depth += (words[i] == '(') - (words[i] == ')');
    if (depth <= 0 && words.substr(i).starts_with("; ")) return i;
  }
  return std::string::npos;
}

// Problem and advice apart, of a sentence if there is no problem yet.
ErrorData split(ErrorData e, const std::string& sentence = "") {
  if (e.problem.empty()) e.problem = sentence;
  const std::size_t end = e.advice.empty() ? first_semicolon(e.problem) : e.problem.find("; " + e.advice);
  if (end != std::string::npos) e.advice = e.problem.substr(end + 2), e.problem.resize(end);
  return e;
}

}  // namespace

std::string Thing::words() const { return name.empty() ? kind : kind + " '" + name + "'"; }

std::string Thing::label() const {
  return words() + (type.empty() ? of_plugin(origin) : " (" + type + of_plugin(origin) + ")");
}

Error::Error(const std::string& sentence, ErrorData about)
    : std::runtime_error(""), ErrorData(split(std::move(about), sentence)), sentence_(sentence) {}
Error::Error(ErrorData about)
    : std::runtime_error(""), ErrorData(split(std::move(about))), sentence_(sentence_of(*this)) {}

std::string Error::fact() const { return sentence_.substr(0, sentence_.find(advice.empty() ? "\n" : "; " + advice)); }

void Error::attribute(const Thing& whose, const std::string& label) {
  if (!thing.known() || (thing.kind == whose.kind && thing.name == whose.name)) thing = whose;
  if (labelled_ || label.empty()) return;
  labelled_ = true;
  const std::string place = place_words(*this);
  const std::size_t at = sentence_.starts_with(place) ? place.size() : 0;
  const std::string words = whose.words(), owner = label.ends_with(')') ? label.substr(0, label.rfind(" (")) : label;
  if (!whose.name.empty() && label.ends_with(whose.label()) &&
      sentence_.compare(at, words.size() + 1, words + ":") == 0)
    sentence_.replace(at, words.size(), label);
  else if (sentence_.compare(at, owner.size(), owner) == 0)  // of what is made
    sentence_.replace(at, owner.size(), label);
  else
    sentence_.insert(at, label + ": ");
  if (const auto* outer = dynamic_cast<const std::nested_exception*>(this); outer != nullptr && outer->nested_ptr())
    sentence_ += ": " + thrown_words(outer->nested_ptr());
}

ParameterError::ParameterError(Thing whose, std::string its_key, std::string its_problem)
    : ModelError({.thing = std::move(whose), .key = std::move(its_key), .problem = std::move(its_problem)}) {}

// Out of line, so that each error type has one typeinfo in the process and the host can catch what a plugin throws.
Error::~Error() = default;
ModelError::~ModelError() = default;
ParameterError::~ParameterError() = default;
AssemblyError::~AssemblyError() = default;
SolveError::~SolveError() = default;
StepError::~StepError() = default;
NonFiniteError::~NonFiniteError() = default;
PluginError::~PluginError() = default;
SceneError::~SceneError() = default;
FileError::~FileError() = default;
UserCodeError::~UserCodeError() = default;
InterruptedError::~InterruptedError() = default;

const char* to_string(Error::Kind kind) {
  constexpr const char* kWords[] = {"other",  "model", "assembly", "solve",     "step",  "not finite",
                                    "plugin", "scene", "file",     "user code", "usage", "interrupted"};
  return kWords[static_cast<std::size_t>(kind)];
}

std::string at_time(double t) { return std::isnan(t) ? "" : fmt::format("t = {:.9g} s: ", t); }

std::string of_plugin(const std::string& origin) {
  return origin.empty() || origin == "built in" ? "" : " of plugin " + origin;
}

}  // namespace lockstep
