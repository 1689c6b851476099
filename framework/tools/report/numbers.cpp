// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace lockstep::report {
namespace {

static_assert(std::endian::native == std::endian::little, "the page reads little endian numbers");

constexpr double kSmallest = 1e-36, kLargest = 1e36;  // what single precision holds with all its digits

struct Extent {
  double low = 0, high = 0;
  bool any = false, fits = true;  // fits: single precision has such numbers
};

Extent extent_of(std::span<const double> values) {
  Extent e;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    e.low = e.any ? std::min(e.low, v) : v;
    e.high = e.any ? std::max(e.high, v) : v;
    e.any = true;
    if (const double size = std::abs(v); size > kLargest || (size < kSmallest && size > 0)) e.fits = false;
  }
  return e;
}

}  // namespace

nlohmann::ordered_json Numbers::append(const void* data, std::size_t n, std::size_t width) {
  bytes_.resize((bytes_.size() + 7) / 8 * 8);
  const std::size_t at = bytes_.size();
  bytes_.resize(at + n * width);
  if (n > 0) std::memcpy(bytes_.data() + at, data, n * width);
  return {{"at", at}, {"n", n}, {"bits", 8 * width}};
}

nlohmann::ordered_json Numbers::add(std::span<const float> values) {
  return append(values.data(), values.size(), sizeof(float));
}

nlohmann::ordered_json Numbers::add(std::span<const double> values) {
  return append(values.data(), values.size(), sizeof(double));
}

nlohmann::ordered_json Numbers::add(std::span<const std::uint16_t> values) {
  nlohmann::ordered_json place = append(values.data(), values.size(), sizeof(std::uint16_t));
  place["whole"] = true;
  return place;
}

nlohmann::ordered_json Numbers::add(std::span<const std::uint32_t> values) {
  nlohmann::ordered_json place = append(values.data(), values.size(), sizeof(std::uint32_t));
  place["whole"] = true;
  return place;
}

nlohmann::ordered_json Numbers::add_column(std::span<const double> values) {
  const Extent e = extent_of(values);
  if (!e.fits) return add(values);
  const double size = std::max(std::abs(e.low), std::abs(e.high));
  const bool differences = e.any && e.high - e.low < 1e-2 * size;
  const double base = differences ? 0.5 * (e.low + e.high) : 0;
  std::vector<float> single(values.size());
  std::transform(values.begin(), values.end(), single.begin(), [&](double v) { return static_cast<float>(v - base); });
  nlohmann::ordered_json place = add(single);
  if (base != 0) place["base"] = base;
  return place;
}

std::string Numbers::base64() const {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes_.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes_.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes_.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = (group << 8) | (k < n ? bytes_[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kDigits[(group >> (18 - 6 * k)) & 63] : '=';
  }
  return text;
}

}  // namespace lockstep::report
