// SPDX-License-Identifier: BSD-3-Clause
// Numbers of a report: arrays in one block of bytes, which the page holds as base64 text.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep::report {

/// Arrays, one after another in one block; each begins at a multiple of 8 bytes. Little endian.
class LOCKSTEP_API Numbers {
 public:
  /// Adds an array; returns where it is: {"at": first byte, "n": count, "bits": 32 or 64}.
  /// Of whole numbers, std::uint16_t or std::uint32_t: {..., "bits": 16 or 32, "whole": true}.
  nlohmann::ordered_json add(std::span<const float> values);
  nlohmann::ordered_json add(std::span<const double> values);
  nlohmann::ordered_json add(std::span<const std::uint16_t> values);
  nlohmann::ordered_json add(std::span<const std::uint32_t> values);
  /// Adds a column with single precision, as differences from "base" if they are small against the values: changes in the
  /// last digits of an energy stay visible. With double precision if single has no such numbers.
  nlohmann::ordered_json add_column(std::span<const double> values);
  /// All of it.
  std::string base64() const;

 private:
  template <class Number>
  nlohmann::ordered_json append(std::span<const Number>);

  std::vector<unsigned char> bytes_;
};

}  // namespace lockstep::report
