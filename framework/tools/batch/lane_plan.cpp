#include "framework/tools/batch/lane_plan.h"

#include <algorithm>
#include <typeinfo>

#include <lockstep/joints.h>
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/tools/batch/link_numbers.h"

namespace lockstep::lanes {
namespace {

// Exactly these classes, which are masks only: a subclass could add behaviour that the lanes would ignore.
template <class... Joints>
bool is_any_of(const Lock& link) {
  return ((typeid(link) == typeid(Joints)) || ...);
}
const MarkerLock* plain_lock(const Lock& link) {
  const bool known = is_any_of<Fixed, PointOnLine, PointOnPlane, PlaneOnPlane, Revolute, Cylindrical, AngularAlignment,
                               Oldham, Prismatic, Rzeppa, Homokinetic, Spherical, GenericLock>(link);
  return known ? static_cast<const MarkerLock*>(&link) : nullptr;
}

// Whether its rates need more than coordinates and velocities.
bool reads_solution(const Auxiliary& own, const System& system) {
  if (!own.reads_solution() || !own.vanishes_without_laws()) return own.reads_solution();
  return may_have_laws(system);
}

bool law_on(const Marker& m) { return m.translation_law || m.rotation_law; }
const char* law_word(const Marker& m) { return m.translation_law ? "translation" : "rotation"; }

RowTable rows_of(const System& system) {
  std::vector<bool> modes;
  for (const auto& link : system.links()) modes.push_back(link->active_at_start());
  RowTable table;
  system.lay_out(modes, table);
  return table;
}

}  // namespace

std::string unsuited_link(const Lock& link) {
  const std::string who = "link '" + link.name() + "' ";
  const MarkerLock* lock = plain_lock(link);
  if (!lock)
    return who + "(" + std::string(link.type()) +
           ") is no lock of markers alone; only joints that are a mask run in lanes";
  for (const Marker* m : {&lock->p(), &lock->s()})
    if (law_on(*m)) return who + "has the marker '" + m->name + "', which has a " + law_word(*m) + " law";
  const int P = lock->p().body->slot, S = lock->s().body->slot;
  if (P == S) return who + "joins two bodies that move as one";
  return "";
}

std::string unsuited(const System& system) {
  for (const auto& own : system.auxiliaries())
    if (reads_solution(*own, system))
      return "the states of '" + own->name() + "' read accelerations or reactions, which lanes do not keep";
  if (system.n_slots() == 0) return "nothing moves";
  for (const auto& force : system.forces())
    if (force->is_switched()) return "force '" + force->name() + "' is switched by events";
  for (const auto& force : system.forces())
    if (force->reacting() != nullptr)
      return "force '" + force->name() + "' (" + std::string(force->type()) + ") reads the reactions of links";
  for (const auto& link : system.links())
    if (link->unilateral()) return "link '" + link->name() + "' is one-sided, and lanes know no impacts";
  for (const auto& link : system.links())
    if (system.left_out(*link) != 0)
      return "rows of link '" + link->name() + "' are left out, and lanes have all of them";
  if (system.held_down_to() > 0) return "rows hold that nearly depend on others, which lanes do not factor";
  return "";
}

std::string unsuited_rows(const System& system) {
  if (system.plane())
    return "the system is planar (three velocities a body), and lanes have rows in space; take \"planar\" out";
  const RowTable rows = rows_of(system);
  for (const RowEntry& e : rows.entries)
    if (const std::string why = unsuited_link(*system.links()[e.link]); !why.empty()) return why;
  std::vector<int> links(static_cast<std::size_t>(system.n_slots()));
  for (const RowEntry& e : rows.entries)
    for (int i = 0; i < e.slots.n; ++i)
      if (++links[e.slots[i]] > schur::Plan::kHub)
        return "body '" + system.body_of_slot(e.slots[i]).name + "' carries more than " +
               std::to_string(schur::Plan::kHub) + " links";
  return "";
}

Turn turn_of(const MarkerLock& lock) {
  if (!overlaps(lock.rows(), Mask::e123)) return Turn::none;
  if (lock.laws() & with::qD) return Turn::law;
  return lock.laws() & with::parallel ? Turn::parallel : Turn::plain;
}

namespace {

Link link_of(const schur::Node& node, const RowEntry& e, const MarkerLock& lock, Plan& plan) {
  Link link;
  link.link = e.link;
  link.m = node.m, link.x = node.x;
  link.triple = node.turned;
  link.moved = lock.laws() & with::p;
  link.turn = turn_of(lock);
  for (int k = 0, next = 0; k < 6; ++k)
    if (includes(lock.rows(), row_bit(k))) link.row[next++] = k;
  const int P = lock.p().body->slot, S = lock.s().body->slot;
  link.P = P == kGround ? plan.n_slots : P, link.S = S == kGround ? plan.n_slots : S;
  for (int i = 0; i < node.n_sides; ++i) (e.slots[i] == P ? link.side_P : link.side_S) = node.first_side + i;
  link.frames = plan.size_frames;
  plan.size_frames += frames::size;
  link.law = plan.size_law;
  if (link.has_laws()) plan.size_law += law::size;
  return link;
}

}  // namespace

Plan make_plan(const System& system) {
  const RowTable rows = rows_of(system);
  Plan plan;
  static_cast<schur::Plan&>(plan) = schur::make_plan(rows, system.n_slots(), false, schur::Storage::lanes);
  plan.n_states = system.n_states();
  for (const schur::Node& node : plan.nodes) {
    const RowEntry& e = rows.entries[node.link];
    plan.links.push_back(link_of(node, e, static_cast<const MarkerLock&>(*system.links()[e.link]), plan));
  }
  return plan;
}

}  // namespace lockstep::lanes
