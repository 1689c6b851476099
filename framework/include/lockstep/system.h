// SPDX-License-Identifier: BSD-3-Clause
// The system: bodies, markers, joints and forces, and their connections. Evaluated by author/passes.h.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/detail/counted_angle.h>
#include <lockstep/error.h>
#include <lockstep/state.h>

namespace lockstep {

class Auxiliary;
class Force;
class Lock;
template <class L>
void check_facets();
template <class F>
void check_force_facets();

// Poses and twists of bodies in a state, read and set independently of the coordinates that the state stores.

/// Pose of a body's frame in the world: m, and a unit quaternion.
LOCKSTEP_API Pose body_pose(const Body&, const State&);
/// Twist of a body's frame: velocity of its origin, world, m/s; angular velocity, body axes, rad/s.
LOCKSTEP_API Twist body_twist(const Body&, const State&);

/// Reads and sets the motion of bodies in a state, for code that changes a state: Event::change, a start for
/// Simulation::set_state. The motion set need not satisfy the joints; the receiver of the state makes it consistent.
/// Bodies that are merged into one slot move together.
class LOCKSTEP_API StateEditor {
 public:
  /// Edits `state`, which must outlive the editor.
  explicit StateEditor(State& state) : state_(state) {}
  /// As lockstep::body_pose().
  Pose pose(const Body& body) const { return lockstep::body_pose(body, state_); }
  /// As lockstep::body_twist().
  Twist twist(const Body& body) const { return lockstep::body_twist(body, state_); }
  /// Sets the pose of the body's frame in the world; its twist stays. Throws ModelError for a body that does not move.
  void set_pose(const Body&, const Pose&);
  /// Sets the twist of the body's frame. Throws ModelError for a body that does not move.
  void set_twist(const Body&, const Twist&);

 private:
  State& state_;
};

// ControlInput: a number that a host sets between the steps of a run.

/// A named number that a host sets while a mechanism runs, as a controller does, and that forces and laws read by
/// reference. A value set between two steps acts from the next step on, with any method. It keeps its value from run to
/// run; checkpoints save and restore it. Set it in the thread of the run, and outside of forces, joints and laws. If it
/// makes the law of a drive jump in velocity, velocities jump with it. A jump in position is an AssemblyError of the
/// next step, until the input is set back.
class LOCKSTEP_API ControlInput {
 public:
  /// As System::add_input().
  ControlInput(std::string name, double value, std::string unit);
  ControlInput(const ControlInput&) = delete;
  ControlInput& operator=(const ControlInput&) = delete;
  const std::string& name() const { return name_; }  ///< name in the system
  const std::string& unit() const { return unit_; }  ///< as given; "" without one
  double value() const { return value_; }            ///< as set last
  /// Sets the value. Throws ParameterError, which names the input, for one that is not finite; the value then stays.
  void set(double value) {
    if (!std::isfinite(value)) refuse(value);
    value_ = value;
  }

 private:
  [[noreturn]] void refuse(double value) const;
  std::string name_, unit_;
  double value_ = 0;
};

// System: the description. It is const while anything is evaluated.

/// Pose of both markers of a new joint at the start: a point, world, m, and axes, unit quaternion.
inline Pose pose_at(const Vec3& x, const Quat& q = {}) { return {x, q}; }
/// The same with the markers' z axis along `z`, of any length but zero; x is as near to the world's x as possible (to
/// its y for z along x). Throws ModelError for a zero z.
LOCKSTEP_API Pose pose_at(const Vec3& x, const Vec3& z);

/// How to treat nearly redundant constraints: dependent on others with a relative singular value below 1e-3 (rows of
/// length 1, rotations as lengths by System::length), in all configurations. Example: a door on two hinges with axes
/// 1e-7 m apart. Held, they lock the door by forces 1e7 times the load; free, the door rotates and one hinge yields by
/// that much. Small loops of a large mechanism are also below the limit, although their constraints are meant to hold.
enum class NearlyRedundant {
  reported,  ///< report only: nothing is decided, and solvers may differ
  free,      ///< redundant and nearly redundant constraints are left out
  held,      ///< they hold; exactly redundant constraints are left out, so that nothing contradicts
  /// Free, unless joints would open or nothing more could move: those are held. Reported if the mechanism has more than
  /// 300 rows.
  automatic
};

/// A mechanism: its bodies, markers, joints and forces, and the results of setup(). To use a joint or force, include
/// the header of its type, or author/lock.h and author/force.h.
class LOCKSTEP_API System final : public AngleCounter {
 public:
  /// Options of a new system.
  struct Options {
    Vec3 gravity = Vec3::Zero();  ///< m/s^2, world
  };
  System() : System(Options{}) {}    ///< without gravity
  explicit System(Options options);  ///< a system of the ground alone
  ~System();
  System(System&&) noexcept;             ///< references to bodies, markers, joints and forces stay valid
  System& operator=(System&&) noexcept;  ///< references to bodies, markers, joints and forces stay valid

  // -- description. Bodies, markers, joints and forces all have different names. References stay valid.
  Body& ground() { return *ground_; }  ///< the fixed body "ground", whose frame is the world's
  /// A body with its mass properties in its own frame, and the pose of that frame in the world at the start. Throws
  /// ModelError for a name that is empty or taken, invalid mass properties (check_mass()), or a pose that is not finite or
  /// not of a unit quaternion.
  Body& add_body(const std::string& name, const MassProperties&, const Pose& home = {});
  /// A body from a shape, at the shape's pose. Throws likewise.
  Body& add_body(const std::string& name, const Shape& shape) { return add_body(name, shape.mass, shape.home); }
  /// A particle: mass, kg, at x, world, m. Throws ModelError likewise, or for a mass that is not above 0.
  Body& add_particle(const std::string& name, double mass, const Vec3& x);
  /// A body that never moves. Throws likewise.
  Body& add_fixed(const std::string& name, const Pose& home = {});
  /// A marker by its pose in the body's frame. Throws ModelError for a name or pose as above.
  Marker& add_marker(const std::string& name, Body&, const Pose& local = {});
  /// A marker by its pose in the world at the start. Throws likewise.
  Marker& add_marker_at(const std::string& name, Body&, const Pose& world);
  /// Adds a joint. Throws ModelError for nullptr, or a name that is empty or taken.
  Lock& add(std::unique_ptr<Lock>);
  /// Adds a force. Throws likewise.
  Force& add(std::unique_ptr<Force>);
  /// Adds states that are integrated with the motion. Throws ModelError for nullptr.
  Auxiliary& add(std::unique_ptr<Auxiliary>);
  /// Adds an angle that is integrated with the motion, unless one of that name exists; returns the one that exists.
  /// Throws ModelError for nullptr.
  CountedAngle& count(std::unique_ptr<CountedAngle>) override;
  using AngleCounter::count;
  /// All counted angles.
  const std::vector<std::unique_ptr<CountedAngle>>& counted_angles() const { return angles_; }
  /// The counted rotation of p about an axis (0, 1, 2) of s; null if it is not counted.
  const CountedAngle* counted(const Marker& p, const Marker& s, int axis) const;
  /// Adds a number that a host sets, for forces and laws that take the reference. `unit`: for readers. Throws ModelError for
  /// a name that is empty or taken, ParameterError for a value that is not finite.
  ControlInput& add_input(const std::string& name, double value = 0, const std::string& unit = {});
  /// Names numbers, which formulas of channels read (make_channel). In place of an earlier one of this name.
  void define(NamedNumbers);
  const std::vector<NamedNumbers>& defined() const { return defined_; }  ///< by define()
  /// A joint of type L between two bodies, with new markers "<name>.P" and "<name>.S" at one pose in the world. `args`
  /// go to the constructor of L after the markers.
  template <class L, class... Args>
  L& add(const std::string& name, Body& p, Body& s, const Pose& world, Args&&... args) {
    Marker& P = add_marker_at(name + ".P", p, world);
    Marker& S = add_marker_at(name + ".S", s, world);
    return add<L>(name, P, S, std::forward<Args>(args)...);
  }
  /// A joint or force of type L on existing markers. `args` go to its constructor after the markers.
  template <class L, class... Args>
  L& add(const std::string& name, Marker& p, Marker& s, Args&&... args) {
    return add_checked(std::make_unique<L>(name, p, s, std::forward<Args>(args)...));
  }
  /// The same with the options in braces: `sys.add<SpringDamper>("spring", p, s, {.stiffness = 1e4})`.
  template <class L>
  L& add(const std::string& name, Marker& p, Marker& s, typename L::Options options) {
    return add_checked(std::make_unique<L>(name, p, s, std::move(options)));
  }
  Vec3 gravity() const { return options_.gravity; }  ///< acceleration of gravity, world, m/s^2
  /// Sets the acceleration of gravity, world, m/s^2. Call changed() after it when the system is planar.
  void set_gravity(const Vec3& g) { options_.gravity = g; }

  /// Motion in the plane whose normal is this axis of the world (Plane{}: in space): three velocities per body, and no
  /// constraints out of the plane. Exact if axes, forces and starts are in the plane; setup() names any part outside in
  /// an error. `known`: only while all joints and forces declare that they stay in it (stays_in_plane) and none
  /// has a lever arm along the normal, as settle_in_plane() requires. A part added later that does not brings the mechanism
  /// back into space.
  void set_planar(Plane plane, bool known = false) {
    plane_ = plane, plane_is_known_ = known, ready_ = has_left_plane_ = false;
  }
  bool plane_is_known() const { return plane_is_known_; }  ///< as given to set_planar()
  Plane plane() const { return plane_; }                   ///< the plane that was set; motion in space without one

  /// While it exists, a system whose plane is known is evaluated in space, so that motions out of the plane appear.
  /// States stay valid, since slots keep their axes; rows and multipliers are those in space. A system whose plane was
  /// requested stays in it. The system must not be changed meanwhile.
  class LOCKSTEP_API InSpace {
   public:
    explicit InSpace(System&);  ///< sets the system up; it must outlive this
    ~InSpace() { end(); }       ///< as end()
    InSpace(const InSpace&) = delete;
    InSpace& operator=(const InSpace&) = delete;
    Plane plane() const { return plane_; }  ///< to which the system returns; none if it is unchanged
    void end();                             ///< returns to the plane
    void stay();                            ///< leaves the plane for good, for states outside of it

   private:
    void set(Plane, long revision);
    System& system_;
    Plane plane_;
    long revision_;
  };

  /// Whether bodies that are held to one another by a fixed joint without laws, which fits at the start, move as one
  /// slot; such a joint has no rows. `keep`: fixed joints that stay joints, because their reactions are wanted.
  void set_merge(bool merge, std::vector<const Lock*> keep = {}) {
    merge_ = merge, kept_ = std::move(keep), ready_ = false;
  }
  /// After setup: whether the joint was merged into a slot, so that it has neither rows nor a reaction.
  bool merged(const Lock&) const;
  /// Leaves constraints of a joint out of all tables: they hold nothing and have no reaction. Meant for redundant or
  /// nearly redundant ones (decide_nearly_redundant()). An evaluation throws ModelError if one is violated by more than
  /// a hundredth: of length(), or as a number. A drive that is left out is released. `rows`: a bit for each row of the
  /// joint, replacing the earlier ones. Call it after setup. Throws ModelError for a row that the joint does not have.
  void leave_out(const Lock&, unsigned rows);
  /// Constraints that were left out, a bit for each.
  unsigned left_out(const Lock&) const;
  /// Holds nearly redundant constraints, with this least singular value of rows of length 1; 0: there are none. The
  /// accelerations are then computed by DenseSolver, with its own rank limit, in place of the given solver. The value
  /// is not used: its size shows how many digits multipliers lose. Only if no constraint is exactly redundant.
  void hold_down_to(double singular_value) { held_ = singular_value, ready_ = false; }
  /// That value; 0: no such constraints hold.
  double held_down_to() const { return held_; }
  /// After setup in a plane: whether rows or forces have lever arms along its normal. The motion is exact all the same,
  /// since joints hold all bodies in the plane, but their moments about axes in the plane are left out.
  bool has_offsets() const { return found_.has_offsets; }

  // -- finding by name; throws ModelError with the closest name
  Body& body(const std::string& name);                        ///< the body of that name; throws ModelError
  Marker& marker(const std::string& name);                    ///< the marker of that name; throws ModelError
  Lock& link(const std::string& name);                        ///< the joint of that name; throws ModelError
  Force& force(const std::string& name);                      ///< the force of that name; throws ModelError
  ControlInput& input(const std::string& name);               ///< the input of that name; throws ModelError
  const Body& body(const std::string& name) const;            ///< the body of that name; throws ModelError
  const Marker& marker(const std::string& name) const;        ///< the marker of that name; throws ModelError
  const Lock& link(const std::string& name) const;            ///< the joint of that name; throws ModelError
  const Force& force(const std::string& name) const;          ///< the force of that name; throws ModelError
  const std::deque<Body>& bodies() const { return bodies_; }  ///< all bodies; the ground is the first
  /// All markers, in the order in which they were added.
  const std::deque<Marker>& markers() const { return markers_; }
  const std::vector<std::unique_ptr<Lock>>& links() const { return links_; }  ///< all joints, by number
  /// All forces, in the order in which they were added.
  const std::vector<std::unique_ptr<Force>>& forces() const { return forces_; }
  /// All inputs that a host sets, in the order in which they were added.
  std::deque<ControlInput>& control_inputs() { return inputs_; }
  const std::deque<ControlInput>& control_inputs() const { return inputs_; }  ///< the same
  /// All auxiliaries, in the order in which they were added.
  const std::vector<std::unique_ptr<Auxiliary>>& auxiliaries() const { return auxiliaries_; }

  // -- setup
  /// Makes slots, folds markers, and assigns states, memory and groups, unless that was done since the last change.
  /// Throws ModelError for an impossible mechanism, UserCodeError for code of plugins or the host that fails. Dynamics
  /// calls it.
  void setup();
  /// As setup(), but always from scratch, and returns the error of a part that leaves the plane instead of throwing it.
  std::optional<ModelError> try_setup();
  bool ready() const { return ready_; }  ///< whether it is set up and unchanged since
  /// To be called after a body, marker or gravity was altered in place: the next evaluation sets the system up again.
  void changed() { ready_ = false; }
  /// While `run` exists, no body or joint can be added.
  void begin_run(const std::shared_ptr<const void>& run) { run_ = run; }
  long revision() const { return revision_; }                            ///< counts the setups that did something
  int n_slots() const { return static_cast<int>(found_.slots.size()); }  ///< how many slots move
  const Slot& slot(int k) const { return found_.slots[static_cast<std::size_t>(k)]; }  ///< slot k, 0 <= k < n_slots()
  /// The first body of slot k; names the slot in messages.
  const Body& body_of_slot(int k) const { return *slot(k).bodies.front(); }
  /// Unknown velocities: 6 per body, 3 per particle; planar 3 and 2.
  int n_velocities() const { return found_.n_velocities; }
  int n_states() const { return found_.n_states; }  ///< size of State::s
  int n_memory() const { return found_.n_memory; }  ///< size of State::z
  /// How many of State::s, from the first on, control the step of an adaptive integrator by their error; the others are
  /// quadratures and counted angles.
  int n_error_controlled_states() const { return found_.n_controlled; }
  /// The state at the start, t = 0: home poses, start velocities, start values; not yet assembled. Throws ModelError
  /// before setup.
  State start() const;
  /// Throws ModelError when the state belongs to another description: by the sizes of q, v, s, z, modes and watched.
  void check_size(const State&) const;

  /// Characteristic length, m, that converts angles into lengths in norms: the largest of the lever arms of markers on
  /// moving bodies, the radii of gyration of bodies that rotate, and the distances of paired markers at the start. If
  /// these are all less than 1e-6 m, as among particles: the distances of the points that forces connect, else the size
  /// of the bodies, else the distances of the bodies, else 1 m.
  double length() const { return found_.length; }

  /// The results of setup(), for the passes.
  struct Found {
    /// The rows of a joint that hold in the plane of a planar mechanism, a bit for each.
    struct PlanarRows {
      unsigned held : 8 = 0,  ///< those in it
          by_link : 1 = 0;    ///< the joint gathers them itself; see Planar
    };
    std::vector<Slot> slots;              ///< clusters of bodies that move as one
    std::vector<const Lock*> ordered;     ///< joints that have rows, groups one after another
    std::vector<int> group;               ///< group of each of them
    std::vector<bool> merged;             ///< by number of the joint
    std::vector<PlanarRows> planar_rows;  ///< by number of the joint, while planar
    bool has_offsets = false;             ///< as has_offsets()
    int n_velocities = 0,                 ///< as n_velocities()
        n_states = 0,                     ///< as n_states()
        n_controlled = 0,                 ///< as n_error_controlled_states()
        n_memory = 0;                     ///< as n_memory()
    double length = 1e-6;                 ///< as length()
  };
  const Found& found() const { return found_; }  ///< valid until the next setup

 private:
  void check_new_name(const std::string& kind, const std::string& name) const;
  Body& place_body(const std::string& name, const Pose& home);
  void setup_slots();
  bool owns(const Lock&) const;  // after setup
  template <class L>
  L& add_checked(std::unique_ptr<L> made) {
    if constexpr (std::derived_from<L, Force>)
      check_force_facets<L>();
    else
      check_facets<L>();
    return static_cast<L&>(add(std::move(made)));
  }

  Options options_;
  std::deque<Body> bodies_;
  std::deque<Marker> markers_;
  std::vector<std::unique_ptr<Lock>> links_;
  std::vector<std::unique_ptr<Force>> forces_;
  std::vector<std::unique_ptr<Auxiliary>> auxiliaries_;
  std::vector<std::unique_ptr<CountedAngle>> angles_;
  std::unordered_map<std::string, CountedAngle*> angle_of_;
  std::deque<ControlInput> inputs_;
  std::vector<NamedNumbers> defined_;
  Body* ground_ = nullptr;
  // A thing whose name is taken, by the hash of the name, which the thing keeps itself.
  enum class Kind : unsigned char { none, body, marker, link, force, input };
  struct Named {
    std::uint32_t hash = 0, kind : 3 = 0, number : 29 = 0;  // kind none: an empty place; number among those of its kind
  };
  static std::string_view word_of(Kind);
  const std::string& name_of(const Named&) const;
  Named named_thing(std::string_view name) const;  // kind none: there is none
  template <class Things>
  auto& find(const char* kind, Kind, Things&, const std::string& name) const;
  void take_name(const std::string& name, Kind, std::size_t number);
  std::vector<Named> names_;  // by hash: if a place is taken, the next ones are
  std::size_t n_names_ = 0;

  bool ready_ = false;
  std::weak_ptr<const void> run_;
  Plane plane_;
  bool plane_is_known_ = false, has_left_plane_ = false;
  bool merge_ = false;
  std::vector<const Lock*> kept_;
  std::vector<unsigned> left_out_;  // by number of the joint: bits of rows; may be shorter
  double held_ = 0;
  Found found_;
  long revision_ = 0;
};

/// Finds the plane in which the system moves exactly as in space, reactions included, and sets the system up in it:
/// axes, forces, starts and centres of mass are in it, and all joints and forces declare that they keep it there
/// (stays_in_plane). `starts_in`: whether other data of the start are in a plane. Without a plane the system is in
/// space, to be set up, and the result is none.
LOCKSTEP_API Plane settle_in_plane(System&, const std::function<bool(Plane)>& starts_in = {});

}  // namespace lockstep
