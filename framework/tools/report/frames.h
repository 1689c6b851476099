// SPDX-License-Identifier: BSD-3-Clause
// Frames: the data that is drawn, at times of a run.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/step_loop.h>

namespace lockstep::report {

/// A time at which something acted: "event 'grab'", "an impact".
struct Mark {
  double t;  ///< s
  std::string what;
};

/// A joint that was activated or deactivated.
struct Switch {
  double t;  ///< s
  int link;
  bool active;
};

/// The load of a joint or a force, drawn at a marker.
struct Load {
  const Lock* link;    ///< or null
  const Force* force;  ///< or null
  const Marker* at;    ///< on the body on which it acts
};

/// The frames of a run. Each is one row of numbers in single precision:
///
///     of every body that moves:    x (m), q (scalar first), v (m/s), w (rad/s), all in world axes     13
///     of every marker with a law:  x (m), q                                                            7
///     of every load:               force (N), moment about the marker's origin (N m), world axes       6
///
/// A load that cannot be solved for is NaN.
class LOCKSTEP_API Frames final : public Observer {
 public:
  /// Keeps so many bytes at most, but at least `fewest` frames.
  explicit Frames(std::size_t most_bytes, std::size_t fewest = 2) : most_bytes_(most_bytes), fewest_(fewest) {}

  void start(const Sample&) override;   ///< forgets all frames
  void output(const Sample&) override;  ///< adds a frame
  void step(const Sample&) override;    ///< adds one if bodies moved far since the last
  void jumped(const Sample&) override;  ///< adds one at the same time, and a mark
  void finish(const Sample&) override;  ///< adds the last one
  bool saves_all() const override { return false; }

  bool any() const { return !times_.empty(); }
  const System& system() const { return *system_; }                       ///< from the start on
  const std::vector<const Body*>& bodies() const { return bodies_; }      ///< that move
  const std::vector<const Marker*>& markers() const { return markers_; }  ///< that laws move
  const std::vector<Load>& loads() const { return loads_; }
  const std::vector<double>& times() const { return times_; }
  /// By frame: whether something acted since the one before, so that velocities jumped.
  const std::vector<bool>& after_jump() const { return after_jump_; }
  const std::vector<float>& rows() const { return rows_; }  ///< one after another
  std::size_t width() const { return width_; }              ///< numbers of a row
  std::size_t stride() const { return stride_; }            ///< one of so many times is kept
  const std::vector<Mark>& marks() const { return marks_; }
  const std::vector<Switch>& switches() const { return switches_; }
  const std::vector<bool>& modes_at_start() const { return modes_at_start_; }
  /// Least and largest value of the first quantity of a joint with a path; none: 0, 0.
  std::pair<double, double> path_range(int link) const { return paths_[link].value_or(std::pair{0.0, 0.0}); }

 private:
  void add(const Sample&);
  template <class V>
  void put(const V& v) {
    for (Eigen::Index k = 0; k < v.size(); ++k) rows_.push_back(static_cast<float>(v[k]));
  }
  void put_loads(const Sample&);
  void follow_paths(const Inputs&);
  void follow_modes(const State&);
  bool has_moved_far(const Inputs&) const;
  void thin();

  std::size_t most_bytes_, fewest_;
  const System* system_ = nullptr;
  std::vector<const Body*> bodies_;
  std::vector<const Marker*> markers_;
  std::vector<Load> loads_;
  std::size_t width_ = 0, most_ = 0;
  std::vector<double> times_;
  std::vector<bool> after_jump_;
  std::vector<float> rows_;
  std::vector<Mark> marks_;
  std::vector<Switch> switches_;
  std::vector<bool> modes_at_start_, modes_;
  std::vector<std::optional<std::pair<double, double>>> paths_;  // by joint
  std::size_t stride_ = 1, skipped_ = 0;  // of outputs, once there are too many
  double gap_ = 0;                        // s, between frames at least, where bodies moved far
};

}  // namespace lockstep::report
