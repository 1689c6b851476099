// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/numbers.h"

#include <algorithm>
#include <bit>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <cmath>

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

std::size_t Numbers::bytes_of(std::span<const double> values) {
  return std::ranges::all_of(values, fits_single) ? sizeof(float) : sizeof(double);
}

nlohmann::ordered_json Numbers::add_column(std::span<const double> values) {
  if (bytes_of(values) == sizeof(double)) return add(values);
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
  namespace iterators = boost::archive::iterators;
  using Digits = iterators::base64_from_binary<iterators::transform_width<const unsigned char*, 6, 8>>;
  const auto* const begin = reinterpret_cast<const unsigned char*>(bytes_.data());
  std::string text{Digits(begin), Digits(begin + bytes_.size())};
  return text.append((4 - text.size() % 4) % 4, '=');
}

}  // namespace lockstep::report
