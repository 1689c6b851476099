// MarkerLock: the paper's lock. Two markers, a mask, imposed laws, drives: one constraint from which joints are made.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "framework/mechanism/lock/lock.h"
#include "framework/mechanism/lock/marker_frame.h"
#include "framework/mechanism/lock/mask.h"

namespace lockstep {

/// A drive: a law on a coordinate that the mask leaves free; exactly one row more.
struct Drive {
  Axis axis = Axis::rz;
  LawPtr<MotionLaw> law;
  bool speed = false;  ///< the law is the speed; the coordinate is integrated in State::s
  int state = 0;       ///< then: which of the link's states
};

class LOCKSTEP_API MarkerLock : public Lock,
                                public Jointed,
                                public Driven,
                                public Stateful,
                                public Planar,
                                public TangentFormula {
 public:
  /// P on O1, S on O2; rows of `mask` hold P at S. Both markers' bodies must differ.
  MarkerLock(std::string name, Marker& p, Marker& s, Mask mask);
  ~MarkerLock() override;

  // -- laws; before the system is set up
  void move(LawPtr<TranslationLaw> law) override;  ///< p(t), S axes: where P is held, on the rows x y z of the mask
  void turn(LawPtr<RotationLaw> law) override;     ///< q_D(t): P is held at S turned by it
  /// A law on a free coordinate. Throws ModelError: the axis is held by the mask or driven already; a turn whose other
  /// two turns are not held has no axis of its own.
  void drive(Axis axis, LawPtr<MotionLaw> law) override;
  /// The same with the speed given, m/s or rad/s; the coordinate starts where the mechanism does and is integrated.
  void drive_speed(Axis axis, LawPtr<MotionLaw> law) override;

  bool turned() const override { return turn_ != nullptr; }
  Mask mask() const override { return mask_; }
  Mask rows() const override { return rows_; }
  /// with::Bits of the laws present, and of parallel markers; after setup().
  unsigned laws() const { return laws_; }
  const Marker& p() const { return *p_; }
  const Marker& s() const { return *s_; }

  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {{p_, s_}}; }
  void gather(Group, const Inputs&, RowSpan out) const override;
  bool is_weld() const override {
    return rows_ == Mask::all && !move_ && !turn_ && drives_.empty() && !p_->slide && !p_->spin && !s_->slide &&
           !s_->spin;
  }

  // -- facets
  const Jointed* jointed() const override { return this; }
  Jointed* jointed() override { return this; }
  const Driven* driven() const override { return this; }
  const Stateful* stateful() const override { return this; }
  const Planar* planar() const override { return this; }
  Planar* planar() override { return this; }
  const TangentFormula* tangent_formula() const override { return this; }

  int n_drives() const override { return static_cast<int>(drives_.size()); }
  Quantity drive(int d) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  std::string diagnose(double t) const override;

  int n_states() const override { return n_speeds_; }
  void start_states(std::span<double> s) const override;
  void state_rates(const Inputs&, std::span<double> sd) const override;
  void engage(const Inputs&, std::span<double> s) const override;

  bool setup_plane(Plane) override;
  RowLayout planar_layout() const override { return flat_.pair ? RowLayout::pair : RowLayout::planar; }
  void gather_plane(Group, const Inputs&, RowSpan out) const override;
  void tangent(const Inputs&, std::span<const double> lambda, TangentSum& out) const override;

 protected:
  /// A class with rows of its own adds them to what this returns.
  RowPlan plan_rows() override;

 private:
  friend struct MarkerLockGather;
  void add_drive(Drive drive);
  double coordinate(const Drive&, Pose rel, double t) const;  // of P against S, where q_D has turned it
  void refuse_when_set_up(const std::string& what) const;
  Quat imposed_turn(const Inputs&) const;

  Marker* p_;
  Marker* s_;
  Mask mask_, rows_;
  LawPtr<TranslationLaw> move_;
  LawPtr<RotationLaw> turn_;
  std::vector<Drive> drives_;
  int n_speeds_ = 0;

  // made by setup()
  MarkerFrame P_, S_;
  int side1_ = -1, side2_ = -1;  // positions of O1 and O2 in slots(); -1: the ground
  int n_rows_ = 0;
  std::array<int, 6> row_{};  // row k of the link is row row_[k] of the lock
  unsigned laws_ = 0;         // with::Bits of the laws present
  std::vector<double> speed_start_;

  /// The lock in the plane of a planar mechanism: numbers where the plane's i and j stand for x and y.
  struct Flat {
    Plane plane;
    int turn_axis = 0;                                    ///< the axis of S and P along the normal
    bool pair = false;                                    ///< both axes of S in the plane are held
    int n_translations = 0, axes[2] = {0, 0};             ///< those that are held, and which
    bool turn = false;                                    ///< the turn is held
    double uP[2] = {0, 0}, uS[2] = {0, 0}, S[2][2] = {};  ///< origins; axes[k] of S in its slot
    double sign_P = 1, sign_S = 1;                        ///< of the turn axes along the normal
    double e[4] = {1, 0, 0, 0};  ///< (e0, e_a) = (e[0] w + e[1] r, e[2] w + e[3] r) of q2' q1 = (w, n r)
  } flat_;
};

}  // namespace lockstep
