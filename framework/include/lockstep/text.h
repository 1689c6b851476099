// SPDX-License-Identifier: BSD-3-Clause
// Text of messages: the closest name, lists of names, numbers for people.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <lockstep/detail/export.h>

namespace lockstep::text {

/// The candidate nearest to `word` by edit distance (case ignored; an exchange of neighbours is one edit), or "" when
/// that is more than a third of the word's length (at least 1; a single letter has none), or more than 1 with another
/// first letter.
LOCKSTEP_API std::string closest_name(std::string_view word, std::span<const std::string> candidates);

/// `; did you mean "slope"?` or, when no other name is near, `; known: a, b, c` (at most twelve names, then "..."); ""
/// without candidates.
LOCKSTEP_API std::string suggestion(std::string_view word, std::span<const std::string> candidates);

/// "a, b and c"; `last` comes before the last word.
LOCKSTEP_API std::string join(std::span<const std::string> words, std::string_view last = " and ");

/// `s` without the characters of `blanks` at both ends: a view of the same text.
LOCKSTEP_API std::string_view trimmed(std::string_view s, std::string_view blanks = " \t\r");

/// Shortest text that reads back as the same double, in any locale.
LOCKSTEP_API std::string number(double value);

/// At most three significant digits, for messages.
LOCKSTEP_API std::string brief(double value);

}  // namespace lockstep::text
