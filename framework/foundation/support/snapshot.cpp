// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/memory.h>

#include <lockstep/error.h>

namespace lockstep {

void Snapshot::put_text(std::string_view text) {
  put(static_cast<double>(text.size()));
  for (const char c : text) put(static_cast<unsigned char>(c));
}

void Snapshot::put_part(const Snapshot& part) {
  put(static_cast<double>(part.numbers_.size()));
  numbers_.insert(numbers_.end(), part.numbers_.begin(), part.numbers_.end());
}

// Halves of 32 bits, which a double holds.
void Snapshot::put_bits(std::uint64_t bits) {
  put(static_cast<double>(bits & 0xffffffffu)), put(static_cast<double>(bits >> 32));
}

std::uint64_t SnapshotReader::get_bits() {
  std::uint64_t bits = 0;
  for (const int shift : {0, 32}) {
    const long half = get_count();
    if (half < 0 || half > 0xffffffffL) ran_out();
    bits |= static_cast<std::uint64_t>(half) << shift;
  }
  return bits;
}

std::string SnapshotReader::get_text() {
  std::string text(get_size(), ' ');
  for (char& c : text) {
    const double x = get();
    if (!(x >= 0 && x < 256)) ran_out();
    c = static_cast<char>(static_cast<unsigned char>(x));
  }
  return text;
}

SnapshotReader SnapshotReader::get_part() {
  const std::size_t n = get_size();
  const SnapshotReader part(left_.first(n));
  left_ = left_.subspan(n);
  return part;
}

Snapshot SnapshotReader::rest() const {
  Snapshot rest;
  rest.assign({left_.begin(), left_.end()});
  return rest;
}

long SnapshotReader::get_count() {
  constexpr double kMost = 9007199254740992.0;  // 2^53
  const double n = get();
  if (!(n >= -kMost && n <= kMost)) ran_out();
  return static_cast<long>(n);
}

// A size that the remaining numbers can hold, for any content.
std::size_t SnapshotReader::get_size() {
  const double n = get();
  if (!(n >= 0 && n <= static_cast<double>(left_.size()))) ran_out();
  return static_cast<std::size_t>(n);
}

void SnapshotReader::ran_out() {
  throw ModelError("restore() reads more than save() wrote; let both handle the same members in the same order");
}

}  // namespace lockstep
