// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Reads lock-checks.json: configurations of the lock and what must come out, computed with 60 digits.

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tests/support/configuration.h"

namespace lockstep::oracle {

/// One entry. Expected values are looked up by their path in the file, "Cq", "reaction.lam", "functions.screw.J":
/// numbers are 1 x 1, lists columns, lists of lists matrices row by row. Only keys that the file has are there.
struct LockCheck {
  std::string name;
  Configuration input;
  Eigen::Vector3d function_law;  ///< f, fd, fdd of the functions screw, distance, rack
  std::map<std::string, Eigen::MatrixXd> expected;

  bool has(const std::string& path) const { return expected.count(path) != 0; }

  const Eigen::MatrixXd& at(const std::string& path) const {
    const auto found = expected.find(path);
    if (found == expected.end()) throw std::out_of_range("lock-checks entry " + name + " has no value " + path);
    return found->second;
  }
};

/// The file: its entries and the constants of its functions.
struct LockChecks {
  double screw_pitch;  ///< m per turn
  double rack_radius;  ///< m
  std::vector<LockCheck> entries;
};

/// Throws std::runtime_error or nlohmann::json::exception if the file cannot be read or misses an input.
LockChecks load_lock_checks(const std::filesystem::path& file);

}  // namespace lockstep::oracle
