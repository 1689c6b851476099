// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/lock_checks.h"

#include <fstream>

#include <nlohmann/json.hpp>

namespace lockstep::oracle {

namespace {

Eigen::MatrixXd matrix(const nlohmann::json& value) {
  if (value.is_number()) return Eigen::MatrixXd::Constant(1, 1, value.get<double>());
  const auto n_rows = static_cast<Eigen::Index>(value.size());
  const auto n_columns = value.at(0).is_array() ? static_cast<Eigen::Index>(value.at(0).size()) : 1;
  Eigen::MatrixXd m(n_rows, n_columns);
  Eigen::Index i = 0;
  for (const auto& row : value) {
    if (row.is_array()) {
      if (static_cast<Eigen::Index>(row.size()) != n_columns) throw std::runtime_error("lock-checks: ragged matrix");
      for (Eigen::Index j = 0; j < n_columns; ++j) m(i, j) = row.at(j).get<double>();
    } else {
      m(i, 0) = row.get<double>();
    }
    ++i;
  }
  return m;
}

void flatten(const nlohmann::json& object, const std::string& prefix, std::map<std::string, Eigen::MatrixXd>& to) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      flatten(value, prefix + key + ".", to);
    } else {
      to[prefix + key] = matrix(value);
    }
  }
}

// Throws if the key is missing or its length is not that of the vector.
template <int n>
void read(const nlohmann::json& input, const char* key, Eigen::Matrix<double, n, 1>& to) {
  const nlohmann::json& list = input.at(key);
  if (list.size() != static_cast<std::size_t>(n))
    throw std::runtime_error(std::string("lock-checks: length of ") + key);
  for (int i = 0; i < n; ++i) to[i] = list.at(i).template get<double>();
}

Configuration configuration(const nlohmann::json& in) {
  Configuration c;
  read(in, "x1", c.x1), read(in, "v1", c.v1), read(in, "a1", c.a1);
  read(in, "q1", c.q1), read(in, "qd1", c.qd1), read(in, "qdd1", c.qdd1);
  read(in, "w1", c.w1), read(in, "al1", c.al1);
  read(in, "x2", c.x2), read(in, "v2", c.v2), read(in, "a2", c.a2);
  read(in, "q2", c.q2), read(in, "qd2", c.qd2), read(in, "qdd2", c.qdd2);
  read(in, "w2", c.w2), read(in, "al2", c.al2);
  read(in, "uP", c.uP), read(in, "uPd", c.uPd), read(in, "uPdd", c.uPdd);
  read(in, "qP", c.qP), read(in, "qPd", c.qPd), read(in, "qPdd", c.qPdd);
  read(in, "uS", c.uS), read(in, "uSd", c.uSd), read(in, "uSdd", c.uSdd);
  read(in, "qS", c.qS), read(in, "qSd", c.qSd), read(in, "qSdd", c.qSdd);
  read(in, "pD", c.pD), read(in, "pDd", c.pDd), read(in, "pDdd", c.pDdd);
  read(in, "qD", c.qD), read(in, "qDd", c.qDd), read(in, "qDdd", c.qDdd);
  return c;
}

}  // namespace

LockChecks load_lock_checks(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error("cannot open " + file.string());
  const nlohmann::json document = nlohmann::json::parse(stream);
  if (document.at("schema") != "lock-checks/1")
    throw std::runtime_error(file.string() + ": not of schema lock-checks/1");
  LockChecks checks{document.at("screw_pitch"), document.at("rack_radius"), {}};
  for (const auto& entry : document.at("configs")) {
    LockCheck check{entry.at("name"), configuration(entry.at("input")), Eigen::Vector3d::Zero(), {}};
    read(entry, "function_law", check.function_law);
    flatten(entry.at("expected"), "", check.expected);
    checks.entries.push_back(check);
  }
  return checks;
}

}  // namespace lockstep::oracle
