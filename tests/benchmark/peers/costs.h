// SPDX-License-Identifier: BSD-3-Clause
// From runs to costs: the cheapest run of a system within an error, by the rules that keep lucky hits out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lockstep::peers {

inline const std::string kOurs = "lockstep";

/// A run, as a line of the CSV has it.
struct Line {
  std::string system, mechanism, method, status;
  double setting = 0, cpu = 0, error = 0, error_end = 0;
  double steps = 0, evaluations = 0;  ///< as the status says, 0 where it does not
  bool done() const { return status.rfind("ok", 0) == 0; }
  /// It came to an end and was wrong.
  bool wrong() const;
  bool cut_short() const { return status.rfind("over", 0) == 0; }
};
/// Which error is meant: &Line::error (history) or &Line::error_end.
using ErrorOf = double Line::*;

/// Lines that are no runs (the header) are left out.
std::vector<Line> read_lines(const std::string& path);

struct Cost {
  double cpu = 0;      ///< s a simulated s
  bool bound = false;  ///< an upper one: the next coarser run of its method was not made
  bool guess = false;  ///< beyond the budget, continued from the method's two finest runs
  std::string method{};
  double setting = 0;
};
using MaybeCost = std::optional<Cost>;

/// Of one method's runs: the cheapest within `limit` all of whose finer runs stay within twice the limit.
MaybeCost cheapest_of(const std::vector<Line>& method, double limit, ErrorOf error);
/// What the error at the two finest runs promises, when it falls with the cost like cost^-0.8 or better, nothing finer
/// failed, and the promise is within 40 times the dearest run.
MaybeCost continued(const std::vector<Line>& method, double limit, ErrorOf error);

class Costs {
 public:
  explicit Costs(const std::vector<Line>& lines);

  std::vector<std::string> mechanisms() const;                          ///< in the order of Kind
  const std::vector<std::string>& systems() const { return systems_; }  ///< lockstep first
  /// Method by name with its runs; nothing when the pair was not run.
  std::map<std::string, std::vector<Line>> methods(const std::string& mechanism, const std::string& system) const;
  bool tried(const std::string& mechanism, const std::string& system) const;
  MaybeCost cheapest(const std::string& mechanism, const std::string& system, double limit, ErrorOf error) const;
  /// Of all systems but lockstep.
  MaybeCost best_peer(const std::string& mechanism, double limit, ErrorOf error) const;

 private:
  std::vector<std::string> systems_;
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<Line>>> methods_;
};

}  // namespace lockstep::peers
