// TreeBatch: copies in joint coordinates: without a row, or with those that close loops. Private to the room.
#pragma once

#include "framework/tools/batch/batch.h"
#include "framework/tools/batch/tree_closures.h"

namespace lockstep::lanes {

class LOCKSTEP_API TreeBatch final : public Batch {
 public:
  using Trees = std::vector<TreeLayout>;
  /// The trees of copies, one each; none where a copy has none that runs in lanes, `why_not` then says what stands in the
  /// way, by name. The systems are set up, and suited.
  static Trees trees_of(std::span<System* const> systems, Taken taken, std::string& why_not);

  TreeBatch(std::span<System* const> systems, int first, const Trees& trees, const CopiesOptions&);

  const TreePlan& plan() const { return plan_; }
  const TreeStore& numbers() const { return z_; }
  const TreeClosures& closures() const { return closures_; }
  void to_batch(int lane, State&) const override;
  void to_slots(int lane, State&) const override;
  Flags8 evaluate(const double* y, const Numbers8& t, double* rate) override;
  double largest_a(std::size_t lane) const override;
  double largest_alpha(std::size_t lane) const override;
  bool weighs_errors() const override { return n_controlled_ == 0; }
  void take_off_turns(int lane, double* y) const override;
  void start_from(const double* y, const Numbers8& t) override;
  Flags8 change_to(const double* y, const Numbers8& t, const Numbers8& h, std::array<Change, kLanes>& out) override;
  void weigh(const double* error, std::array<Change, kLanes>& out) override;
  void accept(int lane) override;
  void watch_pivots() override;
  double n_small(std::size_t lane) const override { return closures_.n_small(lane); }
  double smallest_pivot(std::size_t lane) const override { return closures_.smallest_pivot(lane); }
  void project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed) override;

 private:
  const JointTree& tree(int lane) const { return *trees_[static_cast<std::size_t>(lane)]; }
  void read_motion(int lane, int slot, Motion& out) const override;
  void fill_joints();
  void follow_laws(double* rate) const;
  void fill_laws(const double* y, const Numbers8& t);
  void fill_laws_of(std::size_t node, int lane, double t);
  void fill_closures(const double* y, const Numbers8& t);
  void move(const double* y, const Numbers8& t, bool with_positions);
  void see_ends();
  void read(std::array<Change, kLanes>& out) const;
  void gather(const double* y, const Numbers8& t);
  void normalize(double* y) const;
  void advance(double* y, const double* d) const;
  Numbers8 largest_of(std::size_t at) const;
  bool project_positions(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>&);
  void project_velocities(double* y, const Numbers8& t, const Flags8& wanted, bool factored,
                          std::array<Landing, kLanes>&);

  std::array<std::shared_ptr<const JointTree>, kLanes> trees_;
  Stabilization stabilization_;
  TreeClosures closures_;
  TreePlan plan_;
  std::vector<std::size_t> node_of_;  // of each slot
  TreeStore z_{};
  Arrays arrays_;                // of z_
  Aligned<double> half_;         // angle of each node
  Aligned<double> start_, now_;  // of steps: end::size packs a node
  alignas(64) std::array<double, 4 * kLanes> sizes_{};
};

}  // namespace lockstep::lanes
