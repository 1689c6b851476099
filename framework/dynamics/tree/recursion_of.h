// RecursionOf: the recursion of bodies in space or in a plane, with their closures. A file that is compiled for several
// instruction sets instantiates it.
#pragma once

#include <utility>

#include "framework/dynamics/tree/loop_closures.h"
#include "framework/dynamics/tree/tree_recursion.h"

namespace lockstep {

/// Bodies: what LoopClosures asks of them, and
///
///     outward(), accelerate(), follow(), read_off(), accelerations(), largest()  as TreeRecursion has them; accelerate()
///                                                                     also with closures
///     add(closures)  adds to the accelerations as found last what the closures' last correction changes
template <class Bodies>
class RecursionOf final : public TreeRecursion {
 public:
  RecursionOf(const JointTree& tree, const System& system, ClosureFronts closures)
      : bodies_(tree, system, !closures.sources.empty()) {
    if (closures.sources.empty()) return;
    closures_.begin(tree, system, std::move(closures));
    correction_.setZero(tree.n_v());
  }
  void outward(const JointTree& tree, const State& y, std::vector<Motion>& motions) override {
    bodies_.outward(tree, y, motions);
  }
  void read(const JointTree&, std::span<const Motion> motions, const RowTable& rows) override {
    read_rows(motions, rows);
  }
  void accelerate(const JointTree& tree, std::span<const Motion> motions, const VecX& f, VecX& vd) override {
    closures_.empty() ? bodies_.accelerate(tree, motions, f, vd) : bodies_.accelerate(tree, motions, f, closures_, vd);
  }
  void follow(const JointTree& tree) override { bodies_.follow(tree); }
  bool met(bool corrected) override { return measure(corrected); }
  void correct(const JointTree& tree, VecX& vd) override {
    find_change(tree, closures_.measured(), correction_);
    closures_.add_correction();
    vd += correction_;
    bodies_.add(closures_);
  }
  void correct(const JointTree& tree, const VecX& r, VecX& dv) override { find_change(tree, r, dv); }
  void read_off(const JointTree& tree, std::span<const Motion> motions, const VecX& a, VecX& vd) override {
    bodies_.read_off(tree, motions, a, vd);
  }
  void accelerations(const JointTree& tree, std::span<const Motion> motions, VecX& a) const override {
    bodies_.accelerations(tree, motions, a);
  }
  ClosureRows& closures() override { return closures_; }
  Largest largest() const override { return bodies_.largest(); }

 private:
  // What is compiled for several instruction sets, which a virtual function cannot be.
  LOCKSTEP_FLAT_CLONES void read_rows(std::span<const Motion> motions, const RowTable& rows) {
    closures_.read(bodies_, motions, rows);
  }
  LOCKSTEP_FLAT_CLONES bool measure(bool corrected) { return closures_.met(bodies_, corrected); }
  LOCKSTEP_FLAT_CLONES void find_change(const JointTree& tree, const VecX& r, VecX& dv) {
    closures_.correct(bodies_, tree, r, dv);
  }

  Bodies bodies_;
  typename Bodies::Closures closures_;
  VecX correction_;
};

}  // namespace lockstep
