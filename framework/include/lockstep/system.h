// The system: who exists and how they are connected.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/force.h>
#include <lockstep/lock.h>
#include <lockstep/rows.h>
#include <lockstep/state.h>

namespace lockstep {

// Poses and twists of bodies in a state, read and set whatever coordinates the state keeps.


/// Pose of a body's frame in the world, m.
LOCKSTEP_API Pose pose(const Body&, const State&);
/// v: velocity of the origin of the body's frame, m/s, world; w: rad/s, the body's axes.
LOCKSTEP_API Twist twist(const Body&, const State&);

/// For user code that changes a state: Event::change, a start for Simulation::set_state. What was set need not fit the
/// links; who takes the state makes it consistent. Bodies that are merged into one move together.
class LOCKSTEP_API StateEditor {
 public:
  explicit StateEditor(State& state) : state_(state) {}
  Pose pose(const Body& body) const { return lockstep::pose(body, state_); }
  Twist twist(const Body& body) const { return lockstep::twist(body, state_); }
  /// Puts the body's frame there; its twist stays. Throws ModelError for a body that does not move.
  void set_pose(const Body&, const Pose&);
  void set_twist(const Body&, const Twist&);

 private:
  State& state_;
};


// System: who exists and how they are connected. Description only; it is const while anything is evaluated.


/// Where two markers of a new link coincide at the start: one point and one set of axes, in the world.
inline Pose pose_at(const Vec3& x, const Quat& q = {}) { return {x, q}; }
/// The same with the markers' z axis along `z` (any length; x and y are chosen).
LOCKSTEP_API Pose pose_at(const Vec3& x, const Vec3& z);

/// Which rows of a link lie in the plane of a planar mechanism.
struct PlanarRows {
  int m = 0;
  std::array<int, kMaxRows> own{};
  bool by_link = false;  ///< the link gathers them itself
};

/// Who exists and how they are connected.
class LOCKSTEP_API System {
 public:
  /// Gravity.
  struct Options {
    Vec3 gravity = Vec3::Zero();  ///< m/s^2, world
  };
  System() : System(Options{}) {}
  explicit System(Options options);
  ~System();
  System(System&&) noexcept;
  System& operator=(System&&) noexcept;

  // -- description; names are unique per kind, everything stays where it is in memory
  Body& ground() { return *ground_; }
  Body& add_body(const std::string& name, const MassProperties&, const Pose& home = {});
  Body& add_body(const std::string& name, const Shape& shape) { return add_body(name, shape.mass, shape.home); }
  Body& add_particle(const std::string& name, double mass, const Vec3& x);
  Body& add_fixed(const std::string& name, const Pose& home = {});
  Marker& add_marker(const std::string& name, Body&, const Pose& local = {});
  Marker& add_marker_at(const std::string& name, Body&, const Pose& world);  ///< by its pose in the world at the start
  Lock& add(std::unique_ptr<Lock>);
  Force& add(std::unique_ptr<Force>);
  Auxiliary& add(std::unique_ptr<Auxiliary>);
  /// A link of type L between two bodies, both markers ("<name>.P" and "<name>.S") at one pose in the world.
  template <class L, class... Args>
  L& add(const std::string& name, Body& p, Body& s, const Pose& world, Args&&... args) {
    Marker& P = add_marker_at(name + ".P", p, world);
    Marker& S = add_marker_at(name + ".S", s, world);
    return add<L>(name, P, S, std::forward<Args>(args)...);
  }
  /// A link or force of type L on existing markers.
  template <class L, class... Args>
  L& add(const std::string& name, Marker& p, Marker& s, Args&&... args) {
    check_facets<L>();
    check_force_facets<L>();
    return static_cast<L&>(add(std::make_unique<L>(name, p, s, std::forward<Args>(args)...)));
  }
  /// The same with the options in braces: sys.add<SpringDamper>("spring", p, s, {.stiffness = 1e4}).
  template <class L>
  L& add(const std::string& name, Marker& p, Marker& s, typename L::Options options) {
    check_facets<L>();
    check_force_facets<L>();
    return static_cast<L&>(add(std::make_unique<L>(name, p, s, std::move(options))));
  }
  Vec3 gravity() const { return options_.gravity; }
  void set_gravity(const Vec3& g) { options_.gravity = g; }

  /// Motion in the plane whose normal is this axis of the world (0 x, 1 y, 2 z): three velocities a body, rows out of
  /// the plane left out. Exact where axes, forces and starts lie in that plane; setup() refuses by name what leaves it.
  void set_planar(Plane plane) { plane_ = plane, ready_ = false; }
  Plane plane() const { return plane_; }

  /// Bodies that are held to one another by a fixed link without a law, at its place at the start, move as one slot and
  /// the link has no rows. `keep`: fixed links whose reactions are wanted; they stay links.
  void set_merge(bool merge, std::vector<const Lock*> keep = {}) {
    merge_ = merge, kept_ = std::move(keep), ready_ = false;
  }
  /// After setup: whether the link went into a slot, so that it has neither rows nor reaction.
  bool merged(const Lock& link) const { return merged_.size() == links_.size() && merged_[index_of(link)]; }
  /// After setup in a plane: whether rows or forces have arms along its normal. The motion is exact all the same, but
  /// moments of the links about axes in the plane are left out.
  bool has_offsets() const { return offsets_; }

  // -- finding; throws ModelError with the closest name
  Body& body(const std::string& name);
  Marker& marker(const std::string& name);
  Lock& link(const std::string& name);
  Force& force(const std::string& name);
  const Body& body(const std::string& name) const;
  const Marker& marker(const std::string& name) const;
  const Lock& link(const std::string& name) const;
  const Force& force(const std::string& name) const;
  const std::deque<Body>& bodies() const { return bodies_; }  ///< the ground is the first
  const std::deque<Marker>& markers() const { return markers_; }
  const std::vector<std::unique_ptr<Lock>>& links() const { return links_; }
  const std::vector<std::unique_ptr<Force>>& forces() const { return forces_; }
  const std::vector<std::unique_ptr<Auxiliary>>& auxiliaries() const { return auxiliaries_; }

  // -- setup: slots, folded markers, states, memory, groups. Throws ModelError. Automatic when the description changed.
  void setup();
  /// The same, always anew; what leaves the plane is handed back in place of being thrown.
  std::optional<ModelError> try_setup();
  bool ready() const { return ready_; }
  /// To be said after a body, marker or gravity was altered in place: the next evaluation sets up anew.
  void changed() { ready_ = false; }
  long revision() const { return revision_; }  ///< counts the setups that did something
  int n_slots() const { return static_cast<int>(slots_.size()); }
  const Slot& slot(int k) const { return slots_[static_cast<std::size_t>(k)]; }
  const Body& body_of_slot(int k) const { return *slot(k).bodies.front(); }  ///< for messages
  int n_velocities() const { return n_velocities_; }  ///< unknown velocities: 6 a body, 3 a particle; planar 3 and 2
  int n_states() const { return n_states_; }
  int n_memory() const { return n_memory_; }
  /// The error of the first so many of State::s controls the step of an adaptive integrator; the others are quadratures.
  int n_error_controlled_states() const { return n_controlled_; }
  /// The state at the start: home poses, start velocities, start values; not yet assembled. Throws ModelError before
  /// setup.
  State start() const;
  /// Throws ModelError when the state was made for another description: sizes of q, v, s, z and modes.
  void check_size(const State&) const;

  // -- evaluation
  /// Row table for the links in force; groups stand one after another. Allocates only beyond what was there.
  void lay_out(const std::vector<bool>& modes, RowTable& table) const;
  /// Poses and twists of ground and slots (quaternions normalised) from the state.
  void motions(const State&, std::vector<Motion>& out) const;
  /// Rows of every active link, group by group.
  void gather_rows(const Inputs&, RowTable& table) const;
  /// Gravity, -w x J w and all forces; f: 6 a slot.
  void gather_forces(const Inputs&, VecX& f) const;
  /// Rates of State::s; `values` as solved.
  void state_rates(const Evaluated& values, VecX& sd) const;
  /// After an accepted step: turn counters of links and forces.
  void accept(const Inputs&, State&) const;
  /// Instants in (t0, t1) where any law jumps, sorted.
  std::vector<double> breakpoints(double t0, double t1) const;

  /// "row e1 of link 'C'" for a row of the table; for messages.
  std::string row_name(const RowTable& table, int row) const;
  /// Turns angles into lengths in norms: the largest of the arms of markers on moving bodies, the radii of gyration of
  /// bodies that turn, and the distances of paired markers at home; at least 1e-6 m.
  double length() const { return length_; }

 private:
  void check_new_name(const std::string& kind, const std::string& name) const;
  void setup_slots();
  std::optional<ModelError> setup_plane();
  void setup_merge();
  void fill_slot(Slot&);
  std::size_t index_of(const Lock&) const;
  void check_plane(const Inputs&, const VecX& f) const;
  void gather_from_space(const Inputs&, RowTable&, int entry) const;
  void setup_links();
  void setup_forces();
  void setup_states();
  void setup_length();

  Options options_;
  std::deque<Body> bodies_;
  std::deque<Marker> markers_;
  std::vector<std::unique_ptr<Lock>> links_;
  std::vector<std::unique_ptr<Force>> forces_;
  std::vector<std::unique_ptr<Auxiliary>> auxiliaries_;
  Body* ground_ = nullptr;
  std::unordered_map<std::string, std::string> names_;  // taken, and by what

  bool ready_ = false;
  Plane plane_;
  bool merge_ = false;
  std::vector<const Lock*> kept_;
  std::vector<bool> merged_;          // by number of the link
  std::vector<std::size_t> part_of_;  // of each body: the first body of its slot
  std::vector<Slot> slots_;
  bool offsets_ = false;
  std::vector<PlanarRows> planar_rows_;  // of each link, while planar
  std::vector<const Lock*> ordered_;     // links, groups one after another
  std::vector<int> group_;               // group of each of them
  int n_velocities_ = 0, n_states_ = 0, n_controlled_ = 0, n_memory_ = 0;
  long revision_ = 0;
  double length_ = 1e-6;
};

/// The plane in which the system moves exactly as in space, reactions included: axes, forces, starts and mass centres
/// lie in it. No plane if there is none. The system's own choice of plane is left as it was.
LOCKSTEP_API Plane find_plane(System&);

}  // namespace lockstep
