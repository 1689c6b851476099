// LockBench: one link of a system, evaluated alone at inputs that are moved by hand.
#pragma once

#include <vector>

#include "framework/tools/check/draw.h"
#include <lockstep/check.h>
#include <lockstep/system.h>

namespace lockstep {

/// Inputs that own their numbers.
struct Place {
  double t = 0;
  std::vector<Motion> motions;  ///< the ground first
  VecX s, z;

  Inputs in() const {
    return {t, motions, {s.data(), static_cast<std::size_t>(s.size())}, {z.data(), static_cast<std::size_t>(z.size())}};
  }
  Motion& slot(int k) { return motions[static_cast<std::size_t>(k + 1)]; }
  const Motion& slot(int k) const { return motions[static_cast<std::size_t>(k + 1)]; }
};

/// The start of a set-up system at time t.
Place home_of(const System&, double t);
/// Bodies moved by up to `reach` times their distance, turned by up to `turn`, with velocities; angular ones up to 2/s.
Place drawn_about(const System&, const Place& home, Draw&, double reach, double turn);
/// Where the bodies are after x seconds without accelerations: x + v x, e exp(w x/2).
void coast(const Place& from, double x, Place& to);

/// "the velocity of body 'cam' along the world's y axis", "the angular velocity of body 'cam' about its y axis".
std::string velocity_name(const System&, int slot, int k);
/// "the translation of body 'cam' along the world's y axis", "the turn of body 'cam' about its y axis".
std::string move_name(const System&, int slot, int k);

/// Rows of one link: J on 6 columns for every slot of the system.
struct LockRows {
  VecX C, Ct, Qhat;
  MatX J;
};

class LockBench {
 public:
  LockBench(const System& system, const Lock& link) : system_(system), link_(link) {}

  /// The rows; alone in its group. What was there before the link wrote: `before`.
  void rows(const Place&, LockRows& out, double before = 0);
  /// The rows of two links gathered as one group; those of the first or the second into `out`.
  void rows_of_two(const Place&, const Lock& other, LockRows& first, LockRows& second);
  /// Whether the last gather wrote beside its numbers: into the padding of the columns, or in front of or behind them.
  bool wrote_padding() const { return wrote_padding_; }
  bool wrote_outside() const { return wrote_outside_; }
  /// s of the link moved along the motion from `from` to `to` (coast), by its own rates.
  void move_states(const Place& from, Place& to) const;

 private:
  void gather(const Place&, Group, double before);
  void read(std::size_t lane, LockRows& out) const;
  void look_beside();

  const System& system_;
  const Lock& link_;
  Aligned<double> numbers_;
  std::size_t n_lanes_ = 0;
  bool wrote_padding_ = false, wrote_outside_ = false;
};

}  // namespace lockstep
