// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/recorder.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <exception>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/user_code.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/record/channel_entry.h"
#include "framework/tools/record/extremes.h"

namespace lockstep {

Recorder::Recorder(System& system, std::vector<Request> requests) {
  table_.add_column("t", "s");
  row_.resize(1);
  for (const Request& r : requests) add(system, r);
}
Recorder::~Recorder() = default;

void Recorder::add(const std::string& name, const std::string& unit, std::function<double(const Sample&)> value) {
  add(Channel{name, unit, std::move(value)});
}

void Recorder::add(Channel channel) {
  if (!channel.value) throw ModelError(fmt::format("column \"{}\" has no function; give it one", channel.name));
  table_.add_column(channel.name, channel.unit);
  follow(channel);
  channels_.push_back(std::move(channel));
  row_.resize(channels_.size() + 1);
}

void Recorder::add(System& system, const Request& request) {
  Channel channel = make_channel(system, request.channel);
  channel.name = request.name;
  add(std::move(channel));
}

void Recorder::follow(const Channel& channel) {
  if (channel.memory) followed_.push_back(channel);
}

namespace {

double value_of(const Channel& c, const Sample& sample) {
  return user_code("channel", c.name, sample.state.t, [&] { return c.value(sample); });
}

channels::FormulaMemory* formula_of(const Channel& c) { return dynamic_cast<channels::FormulaMemory*>(c.memory.get()); }

// Behind the values of all channels.
void add_edges(const std::vector<Channel>& channels, Extremes::Numbers edged, const Sample& s,
               std::vector<double>& out) {
  out.resize(channels.size());
  for (const std::size_t k : edged) formula_of(channels[k])->edges(s, out);
}

// Columns that have edges, as far as they can be computed.
std::vector<std::size_t> edged_of(const std::vector<Channel>& channels, const Sample& s) {
  std::vector<std::size_t> edged;
  std::vector<double> edges;
  for (std::size_t k = 0; k < channels.size(); ++k)
    if (channels::FormulaMemory* const formula = formula_of(channels[k]); formula != nullptr)
      if (edges.clear(); !succeeds([&] { formula->edges(s, edges); }) || !edges.empty()) edged.push_back(k);
  return edged;
}

// Calls the memories of channels at a state, once: all are called, also if one throws, so that no other misses a
// revolution.
template <class Call>
void call_at(const Sample& sample, const std::vector<Channel>& channels, const Call& call) {
  std::exception_ptr first;
  for (const Channel& c : channels) {
    const auto called = [&] { user_code("channel", c.name, sample.state.t, [&] { call(*c.memory); }); };
    if (const std::exception_ptr error = thrown_by(called); !first) first = error;
  }
  if (first) std::rethrow_exception(first);
}

// Writes names and rows.
void save_rows(const Table& table, Snapshot& out) {
  out.put(static_cast<double>(table.n_columns()));
  for (const Column& c : table.columns()) out.put_text(column_title(c));
  out.put(static_cast<double>(table.n_rows()));
  for (std::size_t i = 0; i < table.n_rows(); ++i)
    for (const Column& c : table.columns()) out.put(c.values[i]);
}

// Reads what save_rows() wrote, in place of the table's rows. Throws ModelError if the columns are others.
void load_rows(Table& table, SnapshotReader& in) {
  const long n = in.get_count();
  if (n != static_cast<long>(table.n_columns()))
    throw ModelError(
        fmt::format("the run was saved with {} columns and records {}; record the same columns", n, table.n_columns()));
  for (const Column& c : table.columns())
    if (const std::string title = in.get_text(), own = column_title(c); title != own)
      throw ModelError(fmt::format(
          "the run was saved with column \"{}\" and records \"{}\" in its place; record the same columns", title, own));
  table.clear_rows();
  std::vector<double> row(table.n_columns());
  for (long left = in.get_count(); left > 0; --left) {
    for (double& x : row) x = in.get();
    table.add_row(row);
  }
}

}  // namespace

void Recorder::find_extremes() { extremes_ = std::make_unique<Extremes>(); }

std::span<const ColumnRange> Recorder::ranges() const {
  return extremes_ ? extremes_->ranges() : std::span<const ColumnRange>();
}

void Recorder::exchange(Table& other) {
  if (other.names() != table_.names())
    throw ModelError("recorder: exchange() takes a table with the same columns; make it as a copy of table()");
  std::swap(table_, other);
}

void Recorder::read(const Sample& sample, std::span<double> values) {
  for (std::size_t k = 0; k < channels_.size(); ++k) values[k] = value_of(channels_[k], sample);
}

// A state at which a column cannot be computed is left out: the rows report the reason.
void Recorder::begin_part(const Sample& sample) {
  read_ = kNone;
  if (!extremes_) return;
  at_end_.resize(channels_.size());
  is_continuous_ = succeeds([&] {
    read(sample, at_end_), add_edges(channels_, extremes_->edged(), sample, at_end_);
    extremes_->begin_part(sample.state.t, at_end_);
  });
}

void Recorder::start(const Sample& sample) {
  table_.clear_rows(), last_ = kNone;
  call_at(sample, followed_, [&](Observer& memory) { memory.start(sample); });
  if (extremes_) extremes_->begin(table_.columns(), edged_of(channels_, sample));
  begin_part(sample);
}

void Recorder::inside(const InsideStep& step) {
  for (const Channel& c : followed_) c.memory->inside(step);
  if (!extremes_) return;
  const Sample& end = step.end();
  if (!is_continuous_) return begin_part(end);
  is_continuous_ = succeeds([&] { read(end, at_end_), add_edges(channels_, extremes_->edged(), end, at_end_); });
  if (!is_continuous_) return;
  read_ = end.state.t;
  const Extremes::Look look = [&](double t, Extremes::Numbers columns, std::vector<double>& values) {
    return succeeds([&] {
      const Sample& sample = step.at(t);
      for (const std::size_t k : columns) values[k] = value_of(channels_[k], sample);
      if (extremes_->cuts()) add_edges(channels_, extremes_->edged(), sample, values);
    });
  };
  extremes_->add_step(read_, at_end_, step.along_laws() ? channels::kAlongLaws : 1,
                      step.has_states() ? look : Extremes::Look());
  for (std::size_t k = 0; k < channels_.size(); ++k)
    if (const auto* const f = channels_[k].of_motion ? formula_of(channels_[k]) : nullptr; f != nullptr)
      extremes_->set_resolved(k, f->is_resolved());
}

void Recorder::step(const Sample& sample) {
  call_at(sample, followed_, [&](Observer& memory) { memory.step(sample); });
}

void Recorder::jumped(const Sample& sample) {
  call_at(sample, followed_, [&](Observer& memory) { memory.jumped(sample); });
  begin_part(sample);
}

// A row is added whole. One that cannot be made is requested again when the run continues, as it is lost otherwise.
void Recorder::output(const Sample& sample) {
  row_[0] = sample.state.t;
  const std::span<double> values(row_.begin() + 1, row_.end());
  if (read_ == row_[0])
    std::copy_n(at_end_.begin(), values.size(), values.begin());
  else
    read(sample, values);
  if (extremes_) extremes_->take_row(row_);
  if (tell_) function_code("on_row", tell_, sample.state.t, std::span<const double>(row_));
  if (keeps_) table_.add_row(row_);
  last_ = row_[0];
}

void Recorder::save(Snapshot& out) const {
  save_rows(table_, out);
  out.put(last_), out.put(is_continuous_ ? 1 : 0);
  if (extremes_) extremes_->save(out);
  for (const Channel& c : followed_) c.memory->save(out);
}

bool Recorder::saves_all() const {
  return std::ranges::all_of(followed_, [](const Channel& c) { return c.memory->saves_all(); });
}

void Recorder::load(SnapshotReader& in) {
  load_rows(table_, in);
  last_ = in.get(), is_continuous_ = in.get_flag();
  if (extremes_) extremes_->load(in);
  for (const Channel& c : followed_) c.memory->load(in);
}

}  // namespace lockstep
