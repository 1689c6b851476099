// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/text.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <numeric>

namespace lockstep::text {
namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Optimal string alignment distance (insertion, deletion, substitution, transposition), case ignored, in three rows.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const char x = lower(a[i - 1]), y = lower(b[j - 1]);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (x != y)});
      const bool exchanged = i > 1 && j > 1 && x == lower(b[j - 2]) && y == lower(a[i - 2]);
      if (exchanged) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string with_format(double value, std::chars_format format, int digits) {
  char text[64];
  const auto end = digits < 0 ? std::to_chars(text, text + sizeof text, value)
                              : std::to_chars(text, text + sizeof text, value, format, digits);
  return std::string(text, end.ptr);
}

}  // namespace

std::string closest_name(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& name : candidates) {
    const std::size_t longer = std::max(name.size(), word.size()), shorter = std::min(name.size(), word.size());
    if (longer - shorter >= least) continue;  // as many letters are inserted at least
    const std::size_t d = edit_distance(word, name);
    if (d < least) {
      least = d;
      best = name;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates) {
  const std::string near = closest_name(word, candidates);
  if (!near.empty()) return "; did you mean \"" + near + "\"?";
  if (candidates.empty()) return {};
  constexpr std::size_t kMost = 12;
  const std::size_t n = std::min(kMost, candidates.size());
  std::string text = "; known: " + join(candidates.first(n), ", ");
  if (candidates.size() > n) text += ", ...";
  return text;
}

std::string join(std::span<const std::string> words, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? last : std::string_view(", ");
    text += words[i];
  }
  return text;
}

std::string_view trimmed(std::string_view s, std::string_view blanks) {
  const auto first = s.find_first_not_of(blanks);
  return first == std::string_view::npos ? std::string_view() : s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

std::string number(double value) { return with_format(value, std::chars_format::general, -1); }

std::string brief(double value) { return with_format(value, std::chars_format::general, 3); }

}  // namespace lockstep::text
