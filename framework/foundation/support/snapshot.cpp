#include <lockstep/memory.h>

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

std::uint64_t Snapshot::get_bits() const {
  std::uint64_t bits = 0;
  for (const int shift : {0, 32}) {
    const long half = get_count();
    if (half < 0 || half > 0xffffffffL) ran_out();
    bits |= static_cast<std::uint64_t>(half) << shift;
  }
  return bits;
}

std::string Snapshot::get_text() const {
  std::string text(get_size(), ' ');
  for (char& c : text) {
    const double x = get();
    if (!(x >= 0 && x < 256)) ran_out();
    c = static_cast<char>(static_cast<unsigned char>(x));
  }
  return text;
}

Snapshot Snapshot::get_part() const {
  const std::size_t n = get_size();
  Snapshot part;
  const auto from = numbers_.begin() + static_cast<std::ptrdiff_t>(at_);
  part.numbers_.assign(from, from + static_cast<std::ptrdiff_t>(n));
  at_ += n;
  return part;
}

long Snapshot::get_count() const {
  constexpr double kMost = 9007199254740992.0;  // 2^53
  const double n = get();
  if (!(n >= -kMost && n <= kMost)) ran_out();
  return static_cast<long>(n);
}

// A size that the numbers left can hold, whatever was written.
std::size_t Snapshot::get_size() const {
  const double n = get();
  if (!(n >= 0 && n <= static_cast<double>(numbers_.size() - at_))) ran_out();
  return static_cast<std::size_t>(n);
}

void Snapshot::ran_out() {
  throw ModelError(
      "more is read from a snapshot than was saved; save() and restore() must name the same things in one order");
}

}  // namespace lockstep
