// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/precision/certificate.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <lockstep/error.h>

namespace lockstep {
namespace {

constexpr double kMostDigits = 15, kFewDigits = 6, kNothing = 1e-9, kSameInstant = 1e-9;  // of the run's length

// The largest of n numbers, or of their differences from others; infinite if one is not finite.
double largest(const std::vector<double>& values, std::size_t n, const std::vector<double>* others = nullptr) {
  double most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = std::abs(others == nullptr ? values[i] : values[i] - (*others)[i]);
    most = std::isfinite(x) ? std::max(most, x) : HUGE_VAL;
  }
  return most;
}

// Rows up to the first different times.
std::size_t common_rows(const Table& run, const std::vector<const Table*>& repeats) {
  const std::vector<double>& t = run.columns().front().values;
  std::size_t n = t.size();
  for (const Table* repeat : repeats) {
    const std::vector<double>& other = repeat->columns().front().values;
    n = std::min(n, other.size());
    for (std::size_t i = 0; i < n; ++i)
      if (std::abs(t[i] - other[i]) > kSameInstant * std::max(1e-3, std::abs(t.back() - t.front()))) n = i;
  }
  return n;
}

double digits_of(double size, double difference) {
  if (difference == 0) return kMostDigits;
  if (!std::isfinite(difference) || !std::isfinite(size)) return 0;
  return std::clamp(std::log10(size / difference), 0.0, kMostDigits);
}

}  // namespace

Agreement CertifiedChannel::worst() const {
  Agreement least{0, kMostDigits};
  for (const Agreement& a : by) {
    least.difference = std::max(least.difference, a.difference);
    least.digits = std::min(least.digits, a.digits);
  }
  return least;
}

Certificate certify(const Table& run, const std::vector<const Table*>& repeats, double exchanged) {
  for (const Table* repeat : repeats)
    if (run.names() != repeat->names())
      throw ModelError("the repeated run has other columns than the run; record the same channels in both");
  Certificate c;
  c.n_rows = common_rows(run, repeats);
  c.cut = c.n_rows < run.n_rows() ||
          std::any_of(repeats.begin(), repeats.end(), [&](const Table* r) { return c.n_rows < r->n_rows(); });
  std::map<std::string, double> of_unit{{"J", exchanged}};  // largest in each unit
  for (std::size_t k = 1; k < run.n_columns(); ++k) {
    double& most = of_unit[run.columns()[k].unit];
    most = std::max(most, largest(run.columns()[k].values, c.n_rows));
  }
  for (std::size_t k = 1; k < run.n_columns(); ++k) {
    const Column& column = run.columns()[k];
    double most = largest(column.values, c.n_rows);
    CertifiedChannel channel{column.name, column.unit, column.unit == "J" ? std::max(most, exchanged) : most};
    for (const Table* repeat : repeats) {
      const std::vector<double>& other = repeat->columns()[k].values;
      const double difference = largest(column.values, c.n_rows, &other);
      most = std::max(most, largest(other, c.n_rows));
      channel.by.push_back({difference, digits_of(channel.size, difference)});
    }
    channel.zero =
        most == 0 || (most <= kNothing * std::max(1.0, of_unit[column.unit]) && channel.worst().digits < kFewDigits);
    c.channels.push_back(std::move(channel));
  }
  return c;
}

std::vector<std::string> without_a_digit(const Certificate& c) {
  std::vector<std::string> names;
  for (const CertifiedChannel& channel : c.channels)
    if (!channel.zero && channel.worst().digits < 1) names.push_back(channel.name);
  return names;
}

std::string certificate_text(const Certificate& c, const std::vector<std::string>& names) {
  std::size_t width = 8, unit = 4;
  for (const CertifiedChannel& channel : c.channels) {
    width = std::max(width, channel.name.size());
    unit = std::max(unit, channel.unit.size());
  }
  const auto digits = [](const CertifiedChannel& channel, const Agreement& a) {
    if (channel.zero) return a.difference == 0 ? std::string("zero") : fmt::format("zero to {:.0e}", a.difference);
    return fmt::format("{}{:.1f}", a.digits >= kMostDigits ? ">= " : "", std::min(a.digits, kMostDigits));
  };
  std::string text =
      fmt::format("  {:<{}}  {:<{}}  {:>10}  {:>10}", "channel", width, "unit", unit, "scale", "difference");
  for (const std::string& name : names) text += fmt::format("  {:>{}}", name, std::max<std::size_t>(15, name.size()));
  text += "\n";
  for (const CertifiedChannel& channel : c.channels) {
    text += fmt::format("  {:<{}}  {:<{}}  {:>10.3g}  {:>10.1e}", channel.name, width, channel.unit, unit, channel.size,
                        channel.worst().difference);
    for (std::size_t i = 0; i < channel.by.size(); ++i)
      text += fmt::format("  {:>{}}", digits(channel, channel.by[i]), std::max<std::size_t>(15, names[i].size()));
    text += "\n";
  }
  return text;
}

}  // namespace lockstep
