// SPDX-License-Identifier: BSD-3-Clause
// Numbers of a report: arrays in one block of bytes, which the page holds as base64 text.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep::report {

/// Arrays, one after another in one block; each begins at a multiple of 8 bytes. Little endian.
class LOCKSTEP_API Numbers {
 public:
  /// Adds an array; returns where it is: {"at": first byte, "n": count, "bits": 32 or 64}.
  /// Of whole numbers, std::uint16_t or std::uint32_t: {..., "bits": 16 or 32, "whole": true}.
  template <class Number>
  nlohmann::ordered_json add(std::span<const Number> values) {
    const auto bytes = std::as_bytes(values);
    bytes_.resize((bytes_.size() + 7) / 8 * 8);
    nlohmann::ordered_json place{{"at", bytes_.size()}, {"n", values.size()}, {"bits", 8 * sizeof(Number)}};
    if (std::is_integral_v<Number>) place["whole"] = true;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return place;
  }
  /// Adds a column with single precision, as differences from "base" if they are small against the values: changes in the
  /// last digits of an energy stay visible. With double precision if single has no such numbers.
  nlohmann::ordered_json add_column(std::span<const double> values);
  /// Bytes of each number of such a column.
  static std::size_t bytes_of(std::span<const double> values);
  /// All of it.
  std::string base64() const;

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace lockstep::report
