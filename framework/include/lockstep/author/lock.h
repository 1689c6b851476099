// SPDX-License-Identifier: BSD-3-Clause
// The lock: root of all joints.
#pragma once

#include <array>
#include <concepts>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/body.h>
#include <lockstep/detail/lock_facets.h>
#include <lockstep/detail/markers.h>
#include <lockstep/detail/rows.h>
#include <lockstep/state.h>

namespace lockstep {

// Unilateral: what makes a joint of one row push and not pull.

/// A one-sided constraint: C >= 0 in place of C = 0. The joint is inactive while C > 0. When C falls to zero there is
/// an impact; one that would leave a speed below rest_speed activates the joint, until it would have to pull.
struct Unilateral {
  double restitution = 0;    ///< rate of C after an impact over that before it, 0 to 1
  double rest_speed = 1e-3;  ///< smallest rate of C with which an impact ends, above zero; m/s if C is a length
  bool below = false;        ///< the free side is C <= 0 (a rope: the distance may be less than its length)
  double sign() const { return below ? -1.0 : 1.0; }  ///< sign of C on the free side
};

// Lock: a constraint between bodies, the root of all joints. A joint is what the user handles; a lock is the constraint
// it is made of.

class AngleCounter;

/// One row of a joint.
struct LinkRow {
  RowKind kind = RowKind::function;  ///< what it measures
  std::string name;                  ///< "x", "e1", "phi": for messages and channels; unique within the joint
  int drive = -1;                    ///< number of the drive that it belongs to; -1: the joint itself
  friend bool operator==(const LinkRow&, const LinkRow&) = default;  ///< the same in all three
};

/// The properties on which gathering depends. Joints of equal dynamic type, pattern, row count and slot count form a
/// group.
struct LinkPattern {
  unsigned laws = 0;           ///< of a MarkerLock: with::Bits of its laws, and of parallel markers
  Mask rows{},                 ///< of a MarkerLock: all rows of the lock, with those of drives
      mask{};                  ///< of a MarkerLock: without those of drives
  unsigned char grounded = 0;  ///< 1 if the body of P is fixed, plus 2 if that of S is
  /// A total order, so that patterns can be keys of a map.
  friend auto operator<=>(const LinkPattern&, const LinkPattern&) = default;  // NOLINT(modernize-use-nullptr)
};

/// The rows of a joint, as plan_rows() reports them.
struct RowPlan {
  std::vector<LinkRow> rows;            ///< 1 to kMaxRows
  SlotList slots;                       ///< moving slots that the rows have columns on
  LinkPattern pattern;                  ///< what its group is found by
  RowLayout layout = RowLayout::dense;  ///< how the Jacobian is stored: dense or triple
  double sign = 1;                      ///< of a triple, as in RowShape

  /// Adds a row with columns on v and w; a triple becomes dense.
  void add(LinkRow row) { rows.push_back(std::move(row)), layout = RowLayout::dense; }
  /// Adds a row with columns on w only; a triple remains one.
  void add_turning(LinkRow row) { rows.push_back(std::move(row)); }
};

/// A constraint between bodies, the root of all joints. A class defines type(), pairs(), plan_rows() and gather(). All
/// else is an optional facet.
class LOCKSTEP_API Lock {
 public:
  /// `name` is unique in its system.
  explicit Lock(std::string name);
  virtual ~Lock();
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

  // -- to be defined
  virtual std::string_view type() const = 0;  ///< "revolute": the name in files, logs and errors
  /// Marker pairs, P before S. The recorder reports the reaction at P of the first.
  virtual std::vector<std::pair<const Marker*, const Marker*>> pairs() const = 0;
  /// Writes the rows of all joints of one group at the same inputs: C, Ct, Qhat and the Jacobians, every number.
  virtual void gather(Group, const Inputs&, RowSpan out) const = 0;

 protected:
  /// Prepares the joint, whose bodies have their slots, and reports its rows. Throws ModelError, naming the joint.
  virtual RowPlan plan_rows() = 0;

 public:
  // -- facets: `this` of a class that has the facet, else null
  virtual const Driven* driven() const { return nullptr; }                   ///< laws of time
  virtual const Stateful* stateful() const { return nullptr; }               ///< integrated states
  virtual const Remembering* remembering() const { return nullptr; }         ///< memory in State::z
  virtual const TangentFormula* tangent_formula() const { return nullptr; }  ///< a formula for its geometric stiffness
  virtual const Observable* observable() const { return nullptr; }           ///< additional recorder channels
  virtual const Planar* planar() const { return nullptr; }                   ///< rows gathered in a plane
  virtual Planar* planar() { return nullptr; }                               ///< rows gathered in a plane
  virtual const Jointed* jointed() const { return nullptr; }                 ///< a mask, imposed laws and drives
  virtual Jointed* jointed() { return nullptr; }                             ///< a mask, imposed laws and drives
  /// Whether it keeps a mechanism that moves in this plane there: at all times and for all its functions and laws, each
  /// row holds the bodies in the plane or normal to it, never both. Which of the two is read at the start; rows of
  /// functions must then be in the plane. After setup. Default: false, unknown, which keeps the mechanism in space.
  virtual bool stays_in_plane(Plane) const { return false; }
  /// Asks for the angles that it counts, and keeps the references; called by System::setup after its own. Default: none.
  virtual void count_angles(AngleCounter&) {}
  /// Whether it holds its two bodies rigidly together, without any law: they may be merged into one slot.
  virtual bool is_weld() const { return false; }

  // -- set by the user before the system's setup
  bool active_at_start() const { return active_at_start_; }  ///< whether it is active, or watched, at the start
  void set_active_at_start(bool active) { active_at_start_ = active; }  ///< default: it is
  /// Null for a joint that pushes and pulls.
  const Unilateral* unilateral() const { return unilateral_.get(); }
  /// Makes the joint one-sided; it must have exactly one row (checked by setup()). Throws ModelError: a number out of
  /// range.
  void set_unilateral(const Unilateral&);

  const std::string& name() const { return name_; }  ///< name in the system
  /// Origin of its class: "built in", a plugin's name, or "" for a class of the host.
  const std::string& origin() const;
  void set_origin(std::string origin);  ///< called by the registry

  // -- after the system's setup
  /// Stores what plan_rows() reports; called by System::setup. Throws ModelError: no row, more than kMaxRows, or more
  /// than one of a unilateral joint.
  void setup();
  /// Called by System::setup: rows that equal those of another joint, by kind, name and drive, are stored once.
  void share_rows(const Lock& with);
  void set_indices(int number, int first_state, int first_memory);                   ///< called by System::setup
  int row_count() const { return rows_ ? static_cast<int>(rows_->size()) : 0; }      ///< number of rows, in space
  const LinkRow& row(int k) const { return (*rows_)[static_cast<std::size_t>(k)]; }  ///< row k in space
  RowKind row_kind(int k) const { return row(k).kind; }                              ///< what row k measures
  const std::string& row_name(int k) const { return row(k).name; }                   ///< "x", "e1", "phi"
  const SlotList& slots() const { return slots_; }                                   ///< moving slots that it touches
  const LinkPattern& pattern() const { return pattern_; }                            ///< what its group is found by
  RowLayout layout() const { return layout_; }  ///< how its Jacobian in space is stored
  /// Shape of its rows in space.
  RowShape shape() const { return {row_count(), slots_.n, layout_, sign_, {}}; }
  int number() const { return number_; }  ///< in the system: index in State::modes; -1 before setup
  int n_own_states() const { return stateful() ? stateful()->n_states() : 0; }        ///< numbers in State::s
  int n_own_memory() const { return remembering() ? remembering()->n_memory() : 0; }  ///< numbers in State::z
  int first_state() const { return first_state_; }    ///< index of its states in State::s
  int first_memory() const { return first_memory_; }  ///< index of its memory in State::z
  /// Of a unilateral joint: index in State::z of the energy lost in its impacts, J, which the simulation counts.
  int impact_memory() const { return first_memory_ + n_own_memory(); }

 private:
  // What the fewest joints have is held by pointers: mechanisms have hundreds of thousands of joints.
  std::string name_;
  std::unique_ptr<const std::string> origin_;  // null: ""
  std::unique_ptr<const Unilateral> unilateral_;
  std::shared_ptr<const std::vector<LinkRow>> rows_;  // null before setup()
  double sign_ = 1;
  SlotList slots_;
  LinkPattern pattern_;
  RowLayout layout_ = RowLayout::dense;
  bool active_at_start_ = true;
  int number_ = -1, first_state_ = 0, first_memory_ = 0;
};

/// The rows of one joint in space, gathered by themselves in RowTable::alone() of `scratch`.
inline RowBlock gather_alone(const Lock& link, const Inputs& in, RowTable& scratch) {
  const Lock* const one = &link;
  const RowSpan rows = scratch.alone(link.shape());
  link.gather(Group(&one, 1), in, rows);
  return rows.lane(0);
}

/// Adds the geometric stiffness of a joint, by its formula or, if it has none, by differences.
LOCKSTEP_API void add_tangent(const Lock&, const Inputs&, std::span<const double> lambda, TangentSum& out);
/// Adds the geometric stiffness of a joint by central differences of its gather(), to some 1e-9 of K: moves of 6e-6 of
/// the distance between its bodies, rotations of 6e-6 rad.
LOCKSTEP_API void difference_tangent(const Lock&, const Inputs&, std::span<const double> lambda, TangentSum& out);

/// Does not compile for a joint whose facets would not be found.
template <class L>
void check_facets() {
  if constexpr (std::derived_from<L, Lock>)
    static_assert(
        facets_are_found<L, Lock>(&L::driven, &L::stateful, &L::remembering, &L::tangent_formula, &L::observable),
        "a joint that derives from a facet (Driven, Stateful, Remembering, "
        "TangentFormula, Observable) overrides its accessor to return this");
}

// MarkerLock: the paper's lock, the one constraint from which the joints are made.

/// The lock of one pair of markers P and S: rows by a mask, imposed laws, drives.
class LOCKSTEP_API MarkerLock : public Lock,
                                public Jointed,
                                public Driven,
                                public Stateful,
                                public Planar,
                                public TangentFormula {
 public:
  /// Holds P at S in the coordinates of `mask`. Throws ModelError: both markers are on one body.
  MarkerLock(std::string name, Marker& p, Marker& s, Mask mask);
  ~MarkerLock() override;

  // -- laws; before the system is set up
  void move(LawPtr<TranslationLaw> law) override;
  void turn(LawPtr<RotationLaw> law) override;
  void drive(Axis axis, LawPtr<MotionLaw> law) override;
  void drive_speed(Axis axis, LawPtr<MotionLaw> law) override;
  void hold() override;

  bool turned() const override { return imposed().turn != nullptr; }
  bool has_laws() const override;
  const ImposedMotion& imposed() const override;
  Mask mask() const override { return mask_; }
  Mask rows() const override { return rows_; }
  /// with::Bits of its laws, and of parallel markers; after setup().
  unsigned laws() const { return laws_; }
  /// p and its rates at these inputs, by move() and the drives along axes.
  ImposedTranslation imposed_translation(const Inputs& in) const { return imposed().translation(in.t, own_states(in)); }
  /// q_D and its rates at these inputs, by `turn()` and the drive about an axis.
  ImposedRotation imposed_rotation(const Inputs& in) const { return imposed().rotation(in.t, own_states(in)); }
  const Marker& p() const { return *p_; }  ///< marker on body 1
  const Marker& s() const { return *s_; }  ///< marker on body 2

  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {{p_, s_}}; }
  void gather(Group, const Inputs&, RowSpan out) const override;
  bool is_weld() const override {
    return rows_ == Mask::all && imposed().empty() && !p_->translation_law && !p_->rotation_law &&
           !s_->translation_law && !s_->rotation_law;
  }

  // -- facets
  const Jointed* jointed() const override { return this; }
  Jointed* jointed() override { return this; }
  const Driven* driven() const override { return this; }
  const Stateful* stateful() const override { return this; }
  const Planar* planar() const override { return this; }
  Planar* planar() override { return this; }
  const TangentFormula* tangent_formula() const override { return this; }

  int n_drives() const override { return static_cast<int>(imposed().drives.size()); }
  Quantity drive(int d) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  std::string diagnose(double t) const override;

  int n_states() const override { return lawful_ ? lawful_->n_states : 0; }
  void start_states(std::span<double> s) const override;
  void state_rates(const Inputs&, std::span<double> sd) const override;
  void engage(const Inputs&, std::span<double> s) const override;

  bool setup_plane(Plane) override;
  /// As declared by its laws and those of its markers; drives are in the plane. A derived class with additional rows
  /// answers for them.
  bool stays_in_plane(Plane plane) const override { return row_count() == n_rows_ && laws_stay_in_plane(plane); }
  RowLayout planar_layout() const override { return flat_ && flat_->pair ? RowLayout::pair : RowLayout::planar; }
  void gather_plane(Group, const Inputs&, RowSpan out) const override;
  void tangent(const Inputs&, std::span<const double> lambda, TangentSum& out) const override;

 protected:
  /// Whether the laws of the lock and of its markers declare that they keep a mechanism in this plane.
  bool laws_stay_in_plane(Plane) const;
  /// Rows of the mask and of the drives; a derived class adds its own. Throws ModelError: neither body can move, or a
  /// rotation of a particle is held.
  RowPlan plan_rows() override;

 private:
  void add_drive(Drive drive);
  double coordinate(const Drive&, Pose rel, double t) const;               // of P against S as rotated by q_D
  void take_states(const Pose& rel, double t, std::span<double> s) const;  // those of P at this pose against S
  void refuse_when_set_up(const std::string& what) const;
  std::span<const double> own_states(const Inputs& in) const {
    const int n = n_states();
    if (n == 0) return {};
    return in.s.subspan(static_cast<std::size_t>(first_state()), static_cast<std::size_t>(n));
  }
  template <unsigned kWith>
  static void gather_translations(Group, const Inputs&, RowSpan out);
  template <unsigned kWith>
  static void gather_rotations(Group, const Inputs&, RowSpan out);
  void gather_all(Group, const Inputs&, RowSpan out) const;
  void gather_flat(Group, const Inputs&, RowSpan out) const;
  void refuse_leaving_plane(const Inputs&) const;
  void flat_translations(const Inputs&, const RowBlock&) const;
  template <class Law>
  void flat_turn(const Inputs&, const Law&, const RowBlock&) const;

  /// What laws need: of the lock itself, and of its markers. A lock without any has none of it.
  struct Lawful {
    ImposedMotion imposed;
    int n_states = 0;  ///< coordinates of drives of speed, or the pose that is held
    std::vector<double> states_start;
    MarkerFrame P, S;  ///< made by setup(), as the markers move on their slots
  };
  Lawful& lawful();
  MarkerMotion P_at(double t) const;
  MarkerMotion S_at(double t) const;

  /// The lock in the plane of a planar mechanism: vectors by their components along the plane's axes i and j.
  struct Flat {
    Plane plane;
    int turn_axis = 0;                         ///< the axis of S and P along the normal
    bool pair = false;                         ///< both translations in the plane are held
    int n_translations = 0, axes[2] = {0, 0};  ///< how many are held, and along which axes of S
    bool turn = false;                         ///< the rotation is held
    double uP[2] = {0, 0}, uS[2] = {0, 0};     ///< origins
    double S[2][2] = {};                       ///< axes[k] of S in its slot
    double sign = 1;                           ///< of the rotation axis along the normal
    double q[2] = {1, 0};                      ///< q_S' q_P: scalar part, and along the rotation axis
  };

  Marker* p_;
  Marker* s_;
  std::unique_ptr<Lawful> lawful_;  // null: no law acts on it
  Mask mask_, rows_;

  // made by setup()
  signed char side1_ = -1, side2_ = -1;  // positions of O1 and O2 in slots(); -1: the ground
  signed char n_rows_ = 0;
  std::array<signed char, 6> row_{};       // row k of the joint is row row_[k] of the lock
  unsigned laws_ = 0;                      // with::Bits of the laws present
  int slot1_ = kGround, slot2_ = kGround;  // of P and S
  MarkerAtRest P_, S_;                     // without the laws of the markers
  std::unique_ptr<const Flat> flat_;       // null: in space
};

// Reactions: the multipliers of the active joints, for forces that depend on them.

/// A force and a moment about a point.
struct LinkWrench {
  Vec3 force = Vec3::Zero(),  ///< world axes, N
      moment = Vec3::Zero();  ///< world axes, N m
};

/// A view of multipliers as reactions of joints.
class LOCKSTEP_API Reactions {
 public:
  /// One multiplier per row of the table; both must outlive this.
  Reactions(const RowTable& rows, std::span<const double> lambda) : rows_(rows), lambda_(lambda) {}
  /// Of a solution.
  explicit Reactions(const Evaluated& v)
      : Reactions(v.rows, {v.lambda.data(), static_cast<std::size_t>(v.lambda.size())}) {}

  /// Whether the joint has rows in the table.
  bool in_force(const Lock& link) const { return entry(link) >= 0; }
  /// Multipliers of the joint, in the order of its rows in space; zero for rows that a planar mechanism leaves out, and
  /// while the joint is inactive. The generalised force on the bodies is -Jh^T lambda (2.1).
  std::array<double, kMaxRows> of(const Lock& link) const {
    std::array<double, kMaxRows> lambda{};
    if (entry(link) < 0) return lambda;
    const RowEntry& e = rows_.entries[static_cast<std::size_t>(entry(link))];
    for (int k = 0; k < e.m; ++k)
      lambda[static_cast<std::size_t>(e.own[static_cast<std::size_t>(k)])] =
          lambda_[static_cast<std::size_t>(e.first_row + k)];
    return lambda;
  }

  /// A part of a joint's rows. 0, 1, ... is the drive of that number.
  enum Part : int {
    kJoint = -2,  ///< rows of the joint itself
    kDrives = -1  ///< rows of all drives
  };
  /// Whether a row belongs to a part.
  static bool belongs(const LinkRow& row, int part) {
    return part == kJoint ? row.drive < 0 : part == kDrives ? row.drive >= 0 : row.drive == part;
  }
  /// Force and moment of a part of the joint on the body of one of its markers, about the origin of that marker. Zero
  /// while the joint is inactive. The rows must be those gathered at `in`.
  LinkWrench on_body_of(const MarkerFrame& at, const Lock& link, const Inputs& in, int part = kJoint) const;

 private:
  int entry(const Lock& link) const { return rows_.entry_of_link[static_cast<std::size_t>(link.number())]; }
  const RowTable& rows_;
  std::span<const double> lambda_;
};

}  // namespace lockstep
