// Words for messages: the closest name, lists of names, numbers as a person would write them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/export.h>

namespace lockstep {

/// The candidate nearest to `word` by edit distance (case ignored), or "" when none is near (more than a third of the
/// word apart).
LOCKSTEP_API std::string closest_name(std::string_view word, std::span<const std::string> candidates);

/// `; did you mean "slope"?` or, when nothing is near, `; known: a, b, c` (at most twelve names, then "...").
LOCKSTEP_API std::string suggestion(std::string_view word, std::span<const std::string> candidates);

/// "a, b and c"
LOCKSTEP_API std::string join(std::span<const std::string> words, std::string_view last = " and ");

/// Shortest text that reads back as the same double, locale never asked.
LOCKSTEP_API std::string number(double value);

/// Three significant digits, for messages.
LOCKSTEP_API std::string brief(double value);

}  // namespace lockstep
