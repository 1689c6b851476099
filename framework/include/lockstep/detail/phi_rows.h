// SPDX-License-Identifier: BSD-3-Clause
// Rows of any function of the relative coordinates of pairs of markers.
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/lock.h>
#include <lockstep/author/phi.h>
#include <lockstep/author/relative.h>
#include <lockstep/detail/counted_angle.h>
#include <lockstep/detail/rows.h>

namespace lockstep {

/// Two markers, P before S.
using MarkerPair = std::pair<const Marker*, const Marker*>;

/// A function phi of one to three pairs of markers, with the rows and the stiffness that follow from it (theory, (7.2),
/// (7.3)). PhiFunction knows phi itself; FunctionLock and FunctionCoupling are the joints made of it.
class LOCKSTEP_API PhiRows {
 public:
  virtual ~PhiRows();
  PhiRows(const PhiRows&) = delete;
  PhiRows& operator=(const PhiRows&) = delete;

  const PhiSpec& spec() const { return spec_; }                    ///< the declarations of phi
  const std::vector<MarkerPair>& pairs() const { return pairs_; }  ///< as taken
  /// Takes spec().pairs pairs.
  void take(std::vector<MarkerPair> pairs) { pairs_ = std::move(pairs); }

  /// Takes the markers into their slots and calls initialise() of phi. Throws ModelError, naming `link`: phi reads the
  /// rotation of a particle, counts revolutions about z axes opposed at the start, or reads what its spec leaves out.
  void setup(const std::string& link);
  /// Asks for the angles of the pairs whose revolutions are counted. `coupled`: as AngleCounter::count.
  void count_angles(AngleCounter& counter, bool coupled);
  /// Adds the slots of all markers.
  void add_slots(SlotList& slots) const;
  /// Row k, with its name.
  LinkRow row(int k) const;
  const PhiHooks& hooks() const { return *hooks_; }  ///< those of phi

  // -- evaluation; `memory`: what start_memory() and accept_step() wrote
  /// Writes rows first, first + 1, ... of the block, every number of them. `slots`: those of the joint.
  ///
  ///   (7.2)  C = phi,  Ct = phi_y Ct_y + phi_t,  Jh = phi_y Jh_y,  Qhat = phi_y Qhat_y - phi'' along the motion
  virtual void fill(const Inputs& in, const double* memory, const SlotList& slots, int first,
                    const RowBlock& block) const = 0;
  /// (9.11), (9.12) Adds K = lambda ( J_i^T phi_ij J_j + K_lock of each pair ), one multiplier per row.
  void tangent(const Inputs& in, const double* memory, const double* lambda, TangentSum& out) const;
  /// Writes the memory at the start.
  void start_memory(std::span<double> z) const;
  /// Updates the memory after an accepted step.
  void accept_step(const Inputs& in, std::span<double> z) const;
  /// The coordinates of the pairs with their rates along the motion, for channels of a joint; zero for pairs that phi
  /// does not take.
  std::array<LockCoords<Time>, 3> along_motion(const Inputs& in, const double* memory) const;
  /// The rows of phi at coordinates of each pair, with the derivatives along their rates.
  virtual void values(PhiCoords y, std::span<Time> rows) const = 0;

 protected:
  /// Of a function with these declarations.
  explicit PhiRows(const PhiSpec& spec);
  /// The markers of a pair on their slots.
  struct FramePair {
    MarkerFrame P,  ///< marker P
        S;          ///< marker S
  };
  const FramePair& frames(std::size_t k) const { return frames_[k]; }  ///< of pair k
  bool moving() const { return moving_; }                              ///< whether a law moves one of the markers
  /// The expected angle and revolutions of pair k; phi counts them.
  template <class T>
  void expect_angle(LockCoords<T>& y, std::size_t k, const Inputs& in) const {
    y.near_rest = angles_[k]->rest(in.s), y.turns = angles_[k]->turns(in.s);
  }
  PhiHooks* hooks_ = &none_;  ///< those of phi, if it derives from PhiHooks

 private:
  using Coords = std::array<LockCoords<Time>, 3>;
  std::array<RelativeKinematics, 3> look_at(const Inputs& in) const;
  Coords at_start() const;
  PhiCoords given(const Coords& y) const { return {y.data(), pairs_.size()}; }
  void refuse_opposed(const std::string& link, const Coords& y) const;
  void refuse_unread(const std::string& link, Coords y) const;

  PhiSpec spec_;
  PhiHooks none_;
  std::vector<MarkerPair> pairs_;
  std::array<FramePair, 3> frames_;
  std::array<const CountedAngle*, 3> angles_{};  // null: its revolutions are not counted
  bool moving_ = false;
};

}  // namespace lockstep
