// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "framework/tools/charts/chart_style.h"

namespace lockstep::report {
namespace {

static_assert(std::endian::native == std::endian::little, "the page reads little endian numbers");

constexpr double kSmallest = 1e-36, kLargest = 1e36;  // what single precision holds with all its digits

bool fits_single(double v) {
  const double size = std::abs(v);
  return !std::isfinite(v) || size == 0 || (size >= kSmallest && size <= kLargest);
}

}  // namespace

template <class Number>
nlohmann::ordered_json Numbers::append(std::span<const Number> values) {
  bytes_.resize((bytes_.size() + 7) / 8 * 8);
  const std::size_t at = bytes_.size();
  bytes_.resize(at + values.size_bytes());
  if (!values.empty()) std::memcpy(bytes_.data() + at, values.data(), values.size_bytes());
  nlohmann::ordered_json place{{"at", at}, {"n", values.size()}, {"bits", 8 * sizeof(Number)}};
  if (std::is_integral_v<Number>) place["whole"] = true;
  return place;
}
nlohmann::ordered_json Numbers::add(std::span<const float> values) { return append(values); }
nlohmann::ordered_json Numbers::add(std::span<const double> values) { return append(values); }
nlohmann::ordered_json Numbers::add(std::span<const std::uint16_t> values) { return append(values); }
nlohmann::ordered_json Numbers::add(std::span<const std::uint32_t> values) { return append(values); }

nlohmann::ordered_json Numbers::add_column(std::span<const double> values) {
  if (!std::ranges::all_of(values, fits_single)) return add(values);
  chart_style::Extent e{};
  e.take(values, false);
  const double size = std::max(std::abs(e.low), std::abs(e.high));
  const bool differences = e.any && e.high - e.low < 1e-2 * size;
  const double base = differences ? 0.5 * (e.low + e.high) : 0;
  std::vector<float> single(values.size());
  std::transform(values.begin(), values.end(), single.begin(), [&](double v) { return static_cast<float>(v - base); });
  nlohmann::ordered_json place = add(std::span<const float>(single));
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
