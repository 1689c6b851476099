// Lock: a constraint between bodies, the root of all links. A link is what the user handles; a lock is the constraint
// it is made of.
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/foundation/support/export.h"
#include "framework/mechanism/lock/facets.h"
#include "framework/mechanism/lock/unilateral.h"
#include "framework/mechanism/model/marker.h"

namespace lockstep {

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

}  // namespace lockstep
