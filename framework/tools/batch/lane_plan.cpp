// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/lane_plan.h"

#include <typeinfo>

#include <lockstep/author/force.h>
#include <lockstep/detail/kernel.h>
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

}  // namespace

std::string unsuited_link(const Lock& link) {
  const std::string who = "joint '" + link.name() + "' ";
  const MarkerLock* lock = plain_lock(link);
  if (!lock) return who + "(" + std::string(link.type()) + ") is not a joint of a mask alone, as a batch needs";
  for (const Marker* m : {&lock->p(), &lock->s()})
    if (law_on(*m)) return who + "has the marker '" + m->name + "', which has a " + law_word(*m) + " law";
  const int P = lock->p().body->slot, S = lock->s().body->slot;
  if (P == S) return who + "connects two bodies of one rigid group";
  return "";
}

std::string unsuited(const System& system) {
  for (const auto& own : system.auxiliaries())
    if (reads_solution(*own, system))
      return "the states of '" + own->name() + "' read accelerations or reactions, which a batch does not keep";
  if (system.n_slots() == 0) return "nothing moves";
  for (const auto& force : system.forces())
    if (force->is_switched()) return "force '" + force->name() + "' is switched by events";
  for (const auto& force : system.forces())
    if (force->reacting() != nullptr)
      return "force '" + force->name() + "' (" + std::string(force->type()) + ") reads the reactions of joints";
  for (const auto& link : system.links())
    if (link->unilateral()) return "joint '" + link->name() + "' is one-sided, and a batch has no impacts";
  for (const auto& link : system.links())
    if (system.left_out(*link) != 0)
      return "redundant constraints of joint '" + link->name() + "' are left out, which a batch does not support";
  if (system.held_down_to() > 0) return "nearly redundant constraints are kept, which a batch does not support";
  return "";
}

Turn turn_of(const MarkerLock& lock) {
  if (!overlaps(lock.rows(), Mask::e123)) return Turn::none;
  if (lock.laws() & with::qD) return Turn::law;
  return lock.laws() & with::parallel ? Turn::parallel : Turn::plain;
}

}  // namespace lockstep::lanes
