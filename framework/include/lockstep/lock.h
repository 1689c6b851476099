// The lock: root of all links.
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/export.h>
#include <lockstep/kernel.h>
#include <lockstep/law.h>
#include <lockstep/relative.h>
#include <lockstep/rows.h>
#include <lockstep/state.h>

namespace lockstep {

// Facets: what a link may have beside its rows. Lock has an accessor for each that returns null; a class with the facet
// derives from it and lets the accessor return `this`:
//
//   class Thread : public Lock, public Observable {
//    public:
//     const Observable* observable() const override { return this; }
//     ...


class Lock;
/// Links of one type and one pattern, gathered by one call.
using Group = std::span<const Lock* const>;

/// A number that a link or a force reports beyond what every one has: name and unit of a recorder channel.
struct Quantity {
  std::string name, unit;
};

/// A link with laws of time: of its drives, of its rows, of its markers.
class LOCKSTEP_API Driven {
 public:
  /// Drives, each with exactly one row: LinkRow::drive.
  virtual int n_drives() const { return 0; }
  virtual Quantity drive(int) const { return {}; }  ///< name ("rz") and unit (rad, m) of drive d
  /// Instants in (t0, t1) where one of its laws jumps.
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const = 0;
  /// Which of its laws is not finite at time t, in words; "" when none is (then the link itself made the NaN).
  virtual std::string diagnose(double t) const = 0;

 protected:
  ~Driven() = default;
};

/// A link of one pair of markers that holds coordinates by a mask and takes laws on held and on free ones. Laws are
/// given before the system is set up.
class LOCKSTEP_API Jointed {
 public:
  virtual Mask mask() const = 0;    ///< the joint's own rows
  virtual Mask rows() const = 0;    ///< with the drives'
  virtual bool turned() const = 0;  ///< whether turn() imposed a law
  virtual void move(LawPtr<TranslationLaw> law) = 0;
  virtual void turn(LawPtr<RotationLaw> law) = 0;
  virtual void drive(Axis axis, LawPtr<MotionLaw> law) = 0;
  virtual void drive_speed(Axis axis, LawPtr<MotionLaw> law) = 0;

 protected:
  ~Jointed() = default;
};

/// A link that integrates states of its own: numbers in State::s, from Lock::first_state().
class LOCKSTEP_API Stateful {
 public:
  virtual int n_states() const = 0;
  virtual void start_states(std::span<double> s) const = 0;
  virtual void state_rates(const Inputs&, std::span<double> sd) const = 0;
  /// Its states when it comes into force in this pose (an event): a driven speed begins where the mechanism is.
  virtual void engage(const Inputs&, std::span<double>) const {}

 protected:
  ~Stateful() = default;
};

/// A link that remembers: numbers in State::z, from Lock::first_memory(), constant during a step.
class LOCKSTEP_API Remembering {
 public:
  virtual int n_memory() const = 0;
  virtual void start_memory(std::span<double> z) const = 0;
  virtual void accept_step(const Inputs&, std::span<double> z) const = 0;  ///< updates them after an accepted step

 protected:
  ~Remembering() = default;
};

/// A link that gathers its rows in the plane of a planar mechanism itself. Without it, or where it declines, they are
/// taken from gather().
class LOCKSTEP_API Planar {
 public:
  virtual bool setup_plane(Plane) = 0;                                   ///< after setup(); false: it declines
  virtual RowLayout planar_layout() const { return RowLayout::planar; }  ///< or pair
  /// As Lock::gather, for the rows that lie in the plane, in their order.
  virtual void gather_plane(Group, const Inputs&, RowSpan) const = 0;

 protected:
  ~Planar() = default;
};

/// A link that has a formula for its geometric stiffness. Without it, implicit methods take central differences
/// (difference_tangent).
class LOCKSTEP_API TangentFormula {
 public:
  /// K = d(Jh^T lambda)/d(dx, dth) with lambda (one per row of this link) and time fixed; conventions of TangentSum.
  virtual void tangent(const Inputs&, std::span<const double> lambda, TangentSum& out) const = 0;

 protected:
  ~TangentFormula() = default;
};

/// A link with recorder channels of its own.
class LOCKSTEP_API Observable {
 public:
  virtual std::vector<Quantity> quantities() const = 0;
  virtual double quantity(int k, const Inputs&) const = 0;

 protected:
  ~Observable() = default;
};


// Unilateral: what makes a link of one row push and not pull.


/// C >= 0 in place of C = 0. The link is out of force until C falls to zero; then the simulation gives the impact, and
/// where that leaves no speed worth an impact, the link holds until it would have to pull.
struct Unilateral {
  double restitution = 0;    ///< speed of C after an impact to that before it, 0 to 1
  double rest_speed = 1e-3;  ///< impacts that leave less end at rest, m/s (rad/s); above zero
  bool below = false;        ///< C <= 0 is free in place of C >= 0 (a rope: the distance may be less than its length)
  double sign() const { return below ? -1.0 : 1.0; }
};


// Lock: a constraint between bodies, the root of all links. A link is what the user handles; a lock is the constraint
// it is made of.


/// What one row of a link is.
struct LinkRow {
  RowKind kind = RowKind::function;
  std::string name;  ///< "x", "e1", "phi": for messages and channels; unique within the link
  int drive = -1;    ///< number of the drive that it belongs to; -1: the joint itself
};

/// What a kernel is chosen by. Links of equal dynamic type, pattern, row count and slot count make a group.
struct LinkPattern {
  unsigned laws = 0;           ///< of MarkerLock: with::Bits of the laws present, and of parallel markers
  Mask rows{}, mask{};         ///< with the drives', without them
  unsigned char grounded = 0;  ///< 1: P's body, 2: S's
  friend auto operator<=>(const LinkPattern&, const LinkPattern&) = default;
};

/// The rows of a link, as its setup finds them.
struct RowPlan {
  std::vector<LinkRow> rows;  ///< 1 to kMaxRows
  SlotList slots;             ///< whose columns the rows touch
  LinkPattern pattern;
  RowLayout layout = RowLayout::dense;  ///< how the jacobians are kept (rows.h)
  double sign = 1;                      ///< triple: +1 where the first slot is that of P's body

  /// One row more, with columns on v and w. A triple becomes dense by it.
  void add(LinkRow row) { rows.push_back(std::move(row)), layout = RowLayout::dense; }
  /// One row more, with columns on w alone: a triple stays one.
  void add_turning(LinkRow row) { rows.push_back(std::move(row)); }
};

/// Four questions make a constraint: type(), pairs(), plan_rows() and gather(). All else is a facet (facets.h), which a
/// link has or has not.
class LOCKSTEP_API Lock {
 public:
  explicit Lock(std::string name);
  virtual ~Lock();
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

  // -- the four questions
  virtual std::string_view type() const = 0;  ///< "revolute": the name in files, logs and errors
  /// Marker pairs, P before S; the first is the one whose P carries the reaction in the recorder.
  virtual std::vector<std::pair<const Marker*, const Marker*>> pairs() const = 0;
  /// Rows of all links of one group at the same inputs: C, Ct, Qhat and the jacobians; every number is written.
  virtual void gather(Group, const Inputs&, RowSpan out) const = 0;

 protected:
  /// Folds markers into their slots, which the bodies have by now, and says what rows there are; throws ModelError
  /// naming the link.
  virtual RowPlan plan_rows() = 0;

 public:
  // -- facets; null: it has not
  virtual const Driven* driven() const { return nullptr; }
  virtual const Stateful* stateful() const { return nullptr; }
  virtual const Remembering* remembering() const { return nullptr; }
  virtual const TangentFormula* tangent_formula() const { return nullptr; }
  virtual const Observable* observable() const { return nullptr; }
  virtual const Planar* planar() const { return nullptr; }
  virtual Planar* planar() { return nullptr; }
  virtual const Jointed* jointed() const { return nullptr; }
  virtual Jointed* jointed() { return nullptr; }
  /// Whether it holds its two bodies to each other for ever, nothing moving: then they may be merged into one slot.
  virtual bool is_weld() const { return false; }

  // -- what the user sets, before the system's setup
  bool active_at_start() const { return active_at_start_; }
  void set_active_at_start(bool active) { active_at_start_ = active; }
  /// Null: the link pushes and pulls.
  const Unilateral* unilateral() const { return unilateral_ ? &*unilateral_ : nullptr; }
  /// Asks for a link of exactly one row. Throws ModelError when a number is out of its range.
  void set_unilateral(const Unilateral&);

  const std::string& name() const { return name_; }
  /// Who brought its class: "built in", a plugin's name, or "" for a class of the host's own. Set by the registry.
  const std::string& origin() const { return origin_; }
  void set_origin(std::string origin) { origin_ = std::move(origin); }

  // -- after the system's setup
  /// Called by System::setup: keeps what plan_rows() says. Throws ModelError: no rows or too many of them.
  void setup();
  void set_indices(int number, int first_state, int first_memory);  ///< called by System::setup
  int row_count() const { return static_cast<int>(plan_.rows.size()); }
  const LinkRow& row(int k) const { return plan_.rows[static_cast<std::size_t>(k)]; }
  RowKind row_kind(int k) const { return row(k).kind; }
  const std::string& row_name(int k) const { return row(k).name; }
  const SlotList& slots() const { return plan_.slots; }
  const LinkPattern& pattern() const { return plan_.pattern; }
  RowLayout layout() const { return plan_.layout; }
  /// Of its rows in space.
  RowShape shape() const { return {row_count(), plan_.slots.n, plan_.layout, plan_.sign, {}}; }
  int number() const { return number_; }  ///< in the system; index of its bit in State::modes
  int n_own_states() const { return stateful() ? stateful()->n_states() : 0; }
  int n_own_memory() const { return remembering() ? remembering()->n_memory() : 0; }
  int first_state() const { return first_state_; }
  int first_memory() const { return first_memory_; }
  /// Of a unilateral link: one more number in State::z, kept by the simulation: J lost in its impacts.
  int impact_memory() const { return first_memory_ + n_own_memory(); }

 private:
  std::string name_, origin_;
  RowPlan plan_;
  std::optional<Unilateral> unilateral_;
  bool active_at_start_ = true;
  int number_ = -1, first_state_ = 0, first_memory_ = 0;
};

/// The geometric stiffness of a link into `out`: its formula, or differences where it has none.
LOCKSTEP_API void add_tangent(const Lock&, const Inputs&, std::span<const double> lambda, TangentSum& out);
/// The same by central differences of the link's own gather(), good to some 1e-9 of K; moves of 6e-6 of the distance
/// between its bodies, turns of 6e-6 rad.
LOCKSTEP_API void difference_tangent(const Lock&, const Inputs&, std::span<const double> lambda, TangentSum& out);

/// Whether L overrides the accessor of each facet that it derives from: a facet without it would never be found.
template <class L>
constexpr bool facets_are_found() {
  const auto found = []<class Facet>(auto accessor, std::type_identity<Facet>) {
    return !std::derived_from<L, Facet> || !std::same_as<decltype(accessor), const Facet* (Lock::*)() const>;
  };
  return found(&L::driven, std::type_identity<Driven>{}) && found(&L::stateful, std::type_identity<Stateful>{}) &&
         found(&L::remembering, std::type_identity<Remembering>{}) &&
         found(&L::tangent_formula, std::type_identity<TangentFormula>{}) &&
         found(&L::observable, std::type_identity<Observable>{});
}

template <class L>
void check_facets() {
  if constexpr (std::derived_from<L, Lock>)
    static_assert(facets_are_found<L>(),
                  "a link that derives from a facet (Driven, Stateful, Remembering, "
                  "TangentFormula, Observable) overrides its accessor to return this");
}


// MarkerLock: the paper's lock. Two markers, a mask, imposed laws, drives: one constraint from which joints are made.


/// A drive: a law on a coordinate that the mask leaves free; exactly one row more.
struct Drive {
  Axis axis = Axis::rz;
  LawPtr<MotionLaw> law;
  bool speed = false;  ///< the law is the speed; the coordinate is integrated in State::s
  int state = 0;       ///< then: which of the link's states
};

/// The lock of one pair of markers: a mask, imposed laws, drives.
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
  /// Values of all its laws now: moved and driven by, turned and driven by.
  ImposedTranslation imposed_translation(const Inputs&) const;
  ImposedRotation imposed_rotation(const Inputs&) const;
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
  void add_drive(Drive drive);
  double coordinate(const Drive&, Pose rel, double t) const;  // of P against S, where q_D has turned it
  void refuse_when_set_up(const std::string& what) const;
  LawValue value(const Drive&, const Inputs&) const;
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

  /// The lock in the plane of a planar mechanism: numbers in the plane's axes i and j, in place of x and y.
  struct Flat {
    Plane plane;
    int turn_axis = 0;                            ///< the axis of S and P along the normal
    bool pair = false;                            ///< both axes of S in the plane are held
    int n_translations = 0, axes[2] = {0, 0};     ///< those that are held, and which
    bool turn = false;                            ///< the turn is held
    double uP[2] = {0, 0}, uS[2] = {0, 0};        ///< origins
    double S[2][2] = {};                          ///< axes[k] of S in its slot
    double sign = 1;                              ///< of the turn axis along the normal
    double q[2] = {1, 0};                         ///< q_S' q_P: scalar part, and along the turn axis
  } flat_;
};


// Reactions: the multipliers of the links in force, as a force that depends on them sees them.


/// Force, N, and moment about a point, N m.
struct LinkWrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
};

/// Multipliers as forces and moments on slots and markers.
class LOCKSTEP_API Reactions {
 public:
  Reactions(const RowTable& rows, std::span<const double> lambda) : rows_(rows), lambda_(lambda) {}
  explicit Reactions(const Evaluated& v)
      : Reactions(v.rows, {v.lambda.data(), static_cast<std::size_t>(v.lambda.size())}) {}

  bool in_force(const Lock& link) const { return entry(link) >= 0; }
  /// Multipliers of the link, by its own rows; zero for rows that a planar mechanism leaves out and while the link is
  /// not in force. The generalised force on the bodies is -Jh^T lambda (2.1).
  std::array<double, kMaxRows> of(const Lock& link) const {
    std::array<double, kMaxRows> lambda{};
    if (entry(link) < 0) return lambda;
    const RowEntry& e = rows_.entries[static_cast<std::size_t>(entry(link))];
    for (std::size_t k = 0; k < static_cast<std::size_t>(e.m); ++k)
      lambda[static_cast<std::size_t>(e.own[k])] = lambda_[static_cast<std::size_t>(e.first_row) + k];
    return lambda;
  }

  /// Rows of a link that count: the joint's own, those of all its drives, or those of drive number 0, 1, ...
  enum Part : int { kJoint = -2, kDrives = -1 };
  static bool belongs(const LinkRow& row, int part) {
    return part == kJoint ? row.drive < 0 : part == kDrives ? row.drive >= 0 : row.drive == part;
  }
  /// What the link does to the body of one of its markers, about the origin of that marker; world axes. Zero while it
  /// is not in force. The rows must be those gathered at `in`.
  LinkWrench on_body_of(const MarkerFrame& at, const Lock& link, const Inputs& in, int part = kJoint) const;

 private:
  int entry(const Lock& link) const { return rows_.entry_of_link[static_cast<std::size_t>(link.number())]; }
  const RowTable& rows_;
  std::span<const double> lambda_;
};

}  // namespace lockstep
