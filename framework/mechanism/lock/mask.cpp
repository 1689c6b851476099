// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/mask.h>

#include <array>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {
constexpr std::array<std::string_view, 6> kRows{"x", "y", "z", "e1", "e2", "e3"};
constexpr std::array<std::string_view, 6> kAxes{"x", "y", "z", "rx", "ry", "rz"};

int position(const std::array<std::string_view, 6>& words, std::string_view word) {
  for (int k = 0; k < 6; ++k)
    if (words[k] == word) return k;
  return -1;
}
std::string listed(const std::array<std::string_view, 6>& words) {
  return text::join(std::vector<std::string>(words.begin(), words.end()));
}

[[noreturn]] void refuse(const std::string& key, const std::string& problem) { throw ParameterError({}, key, problem); }
}  // namespace

Mask mask_from(std::string_view words) {
  Mask mask = Mask::none;
  while (true) {
    const std::size_t first = words.find_first_not_of(" \t,|");
    if (first == std::string_view::npos) return mask;
    words.remove_prefix(first);
    const std::string_view word = words.substr(0, words.find_first_of(" \t,|"));
    words.remove_prefix(word.size());
    const int k = position(kRows, word);
    if (k < 0)
      refuse("mask", "has the unknown word \"" + std::string(word) + "\"; the words of a mask are " + listed(kRows));
    if (includes(mask, row_bit(k))) refuse("mask", "has the word \"" + std::string(word) + "\" twice; give it once");
    mask = mask | row_bit(k);
  }
}

std::string to_string(Mask mask) {
  std::string words;
  for (int k = 0; k < 6; ++k)
    if (includes(mask, row_bit(k))) words.append(words.empty() ? "" : " ").append(row_name(k));
  return words;
}

Axis axis_from(std::string_view word) {
  const int k = position(kAxes, word);
  if (k < 0) refuse("axis", "is \"" + std::string(word) + "\"; an axis is one of " + listed(kAxes));
  return Axis(k);
}

std::string_view to_string(Axis a) { return kAxes[axis_index(a)]; }
std::string_view row_name(int k) { return kRows[k]; }

}  // namespace lockstep
