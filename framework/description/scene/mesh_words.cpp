// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/mesh_words.h"

#include <charconv>
#include <cmath>
#include <limits>

#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {

MeshWords::MeshWords(std::string file, std::string_view text, char comment)
    : file_(std::move(file)), rest_(text), comment_(comment) {}

std::string_view MeshWords::line() {
  const std::size_t end = rest_.find('\n');
  const std::string_view found = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
  ++line_;
  return found.substr(0, comment_ == 0 ? std::string_view::npos : found.find(comment_));
}

bool MeshWords::next() {
  words_.clear();
  while (!rest_.empty()) {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    std::string_view left = text::trimmed(line(), kBlanks);
    const bool goes_on = !left.empty() && left.back() == '\\';
    if (goes_on) left.remove_suffix(1);
    while (!left.empty()) {
      const std::size_t end = left.find_first_of(kBlanks);
      if (end != 0) words_.push_back(left.substr(0, end));
      left = end == std::string_view::npos ? std::string_view() : left.substr(end + 1);
    }
    if (!words_.empty() && !goes_on) return true;
  }
  return !words_.empty();
}

// As a double first: a number too small for single precision is 0.
float MeshWords::number(std::size_t k) const {
  if (k >= words_.size()) refuse("the line ends where a number should stand");
  std::string_view digits = words_[k];
  if (digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool read = error == std::errc{} && end == digits.data() + digits.size();
  if (!read || !(std::abs(value) <= std::numeric_limits<float>::max()))
    refuse("\"" + std::string(words_[k].substr(0, 40)) + "\" is no number that a mesh can have");
  return static_cast<float>(value);
}

void MeshWords::refuse(const std::string& why) const {
  throw FileError(file_ + ":" + std::to_string(line_) + ": " + why);
}

}  // namespace lockstep
