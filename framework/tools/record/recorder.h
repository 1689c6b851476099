// Recorder: an observer that fills a table. Names become functions once; an output is one row of numbers.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/tools/record/channel.h"
#include "framework/tools/record/table.h"

namespace lockstep {

/// A column of the record: a channel, under its own name or one of the user's ("Bx": "B.force_on_p_world_x").
struct Request {
  std::string name, channel;
  Request(const char* own) : name(own), channel(own) {}             // NOLINT: a bare name is a request
  Request(std::string own) : name(own), channel(std::move(own)) {}  // NOLINT
  Request(std::string given, std::string of) : name(std::move(given)), channel(std::move(of)) {}
};

class LOCKSTEP_API Recorder : public Observer {
 public:
  /// Before the run, and before StepLoop takes the start: some channels integrate with the motion. The first column
  /// is the time, "t [s]". Throws ModelError: an unknown channel, a name that is taken.
  explicit Recorder(System& system, std::vector<Request> requests = {});
  ~Recorder() override;

  /// A column of the user's own.
  void add(const std::string& name, const std::string& unit, std::function<double(const Sample&)> value);
  void add(Channel channel);
  /// Counts turns for a channel that is used elsewhere (an event's condition), without a column.
  void follow(Channel channel);
  /// Memory for n rows in all; beyond it the table grows geometrically.
  void reserve(std::size_t n) { table_.reserve(n); }
  const Table& table() const { return table_; }

  /// A run from a new start begins a new table.
  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void output(const Sample&) override;

 private:
  Table table_;
  std::vector<Channel> channels_;  // of the columns after the first
  std::vector<Channel> followed_;
  std::vector<double> row_;
};

}  // namespace lockstep
