// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/recorder.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cassert>

#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {

void Table::add_column(const std::string& name, const std::string& unit) {
  if (name.empty()) throw ModelError(fmt::format("column {} of the table has no name; give it one", n_columns() + 1));
  if (has(name)) throw ModelError(fmt::format("the table has two columns named \"{}\"; rename one of them", name));
  if (n_rows() > 0)
    throw ModelError(fmt::format("column \"{}\" comes too late: the table has {} rows already; add it before the run",
                                 name, n_rows()));
  columns_.push_back({name, unit, {}});
}

void Table::reserve(std::size_t n) {
  for (Column& c : columns_) c.values.reserve(n);
}

void Table::add_row(std::span<const double> row) {
  assert(row.size() == columns_.size());
  for (Column& c : columns_)  // room in all of them first: a row is there as a whole, or not
    if (c.values.size() == c.values.capacity()) c.values.reserve(2 * c.values.size() + 1);
  for (std::size_t i = 0; i < columns_.size(); ++i) columns_[i].values.push_back(row[i]);
}

void Table::clear_rows() {
  for (Column& c : columns_) c.values.clear();
}

bool Table::has(const std::string& name) const {
  return std::any_of(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
}

std::vector<std::string> Table::names() const {
  std::vector<std::string> all;
  for (const Column& c : columns_) all.push_back(c.name);
  return all;
}

const Column& Table::column(const std::string& name) const {
  for (const Column& c : columns_)
    if (c.name == name) return c;
  throw ModelError(fmt::format("the table has no column \"{}\"{}", name, text::suggestion(name, names())));
}

namespace {

const std::vector<double>& filled(const Column& c) {
  if (c.values.empty()) throw ModelError(fmt::format("column \"{}\" has no rows yet; run first", c.name));
  return c.values;
}

}  // namespace

double Table::first(const std::string& name) const { return filled(column(name)).front(); }
double Table::last(const std::string& name) const { return filled(column(name)).back(); }

std::string column_title(const Column& c) { return c.unit.empty() ? c.name : fmt::format("{} [{}]", c.name, c.unit); }

}  // namespace lockstep
