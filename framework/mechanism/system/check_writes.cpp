// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/system/check_writes.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>

#include <lockstep/author/passes.h>
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr std::size_t kFence = 512;  // numbers on each side, more than the largest block of rows holds
constexpr std::size_t kAtOnce = 64;  // joints of a group: their rows stay in the cache
// A NaN that no arithmetic produces; compared bitwise.
constexpr std::uint64_t kMark = 0x7ff8'dead'beef'cafe;

bool marked(double x) { return std::bit_cast<std::uint64_t>(x) == kMark; }
bool ours(const std::string& origin) { return origin == "built in"; }

// An array between two fences.
class Fenced {
 public:
  explicit Fenced(std::size_t n) : numbers_(n + 2 * kFence, std::bit_cast<double>(kMark)), n_(n) {}
  double* data() { return numbers_.data() + kFence; }
  std::span<double> span() { return {data(), n_}; }
  bool fence_intact() const {
    const auto end = numbers_.end();
    return std::all_of(numbers_.begin(), numbers_.begin() + kFence, marked) && std::all_of(end - kFence, end, marked);
  }
  bool written() const { return std::none_of(numbers_.begin() + kFence, numbers_.end() - kFence, marked); }

 private:
  Aligned<double> numbers_;
  std::size_t n_;
};

template <class T>
[[noreturn]] void reject_writes(const T& thing, const std::string& did) {
  const Thing whose = thing_of(thing);
  throw UserCodeError(whose.label() + " " + did, {.thing = whose, .problem = did});
}

// Marks the numbers of a block that a joint has to write; the others are padding and stay zero.
std::vector<bool> wanted(const RowShape& shape) {
  std::vector<bool> needed(RowSpan::stride(shape), false);
  const auto column = [&](std::size_t at, int n) {
    for (int k = 0; k < n; ++k) needed[at + k] = true;
  };
  const auto ld = static_cast<std::size_t>(shape.ld());
  for (std::size_t c = 0; c < 3; ++c) column(c * ld, shape.m);
  for (int c = 0; c < n_turned(shape.layout); ++c)
    column(shape.R() + static_cast<std::size_t>(c) * ld, n_turned(shape.layout));
  for (int i = 0; i < shape.n; ++i)
    for (int c = 0; c < n_columns(shape.layout); ++c) column(shape.J(i) + static_cast<std::size_t>(c) * ld, shape.m);
  return needed;
}

// "C of constraint phi", "the Jacobian of constraint phi on its body 2"
std::string place_in(const RowShape& shape, const Lock& link, std::size_t at) {
  const auto ld = static_cast<std::size_t>(shape.ld());
  const std::string row = "constraint " + link.row_name(static_cast<int>(at % ld));
  if (at < 3 * ld) return std::string(at < ld ? "C" : at < 2 * ld ? "Ct" : "Qhat") + " of " + row;
  int slot = 0;
  while (slot + 1 < shape.n && at >= shape.J(slot + 1)) ++slot;
  return "the Jacobian of " + row + " on its body " + std::to_string(slot + 1);
}

// Gathers joints of one group in one call, as the evaluation does.
void check_links(Group links, const RowShape& shape, const Inputs& in, bool in_plane) {
  const std::size_t stride = RowSpan::stride(shape);
  Fenced rows(stride * links.size());
  if (!succeeds([&] {
        const RowSpan out(rows.data(), shape);
        if (in_plane)
          links.front()->planar()->gather_plane(links, in, out);
        else
          links.front()->gather(links, in, out);
      }))
    return;
  if (!rows.fence_intact())
    reject_writes(*links.front(), "writes outside of its rows; it has rows 0 to " + std::to_string(shape.m - 1) +
                                      " on its bodies 0 to " + std::to_string(shape.n - 1) +
                                      ": check the indices that its gather() passes to the block");
  const std::vector<bool> needed = wanted(shape);
  for (std::size_t l = 0; l < links.size(); ++l)
    for (std::size_t k = 0; k < stride; ++k) {
      const double x = rows.data()[l * stride + k];
      if (needed[k] && marked(x))
        reject_writes(*links[l],
                      "leaves " + place_in(shape, *links[l], k) +
                          " unwritten; its gather() has to write every number, zeros too, for each joint of the "
                          "group");
      if (!needed[k] && !marked(x) && x != 0)
        reject_writes(*links[l], "writes outside of its rows, beyond row " + std::to_string(shape.m - 1) +
                                     "; check the indices that its gather() passes to the block");
    }
}

template <class T>
void check_numbers(const T& thing, const char* what, int n, bool all,
                   const std::function<void(std::span<double>)>& act) {
  Fenced numbers(static_cast<std::size_t>(n));
  if (!all) std::fill(numbers.span().begin(), numbers.span().end(), 0.0);
  if (!succeeds([&] { act(numbers.span()); })) return;
  const std::string its = "its " + std::to_string(n) + " numbers";
  if (!numbers.fence_intact()) reject_writes(thing, "writes outside of " + its + " in " + what);
  if (all && !numbers.written()) reject_writes(thing, "leaves some of " + its + " unwritten in " + what);
}

// These must come first: System::start() hands them the state itself.
template <class T>
void check_memory(const T& thing) {
  if (const Remembering* own = thing.remembering())
    check_numbers(thing, "start_memory()", own->n_memory(), true, [&](auto z) { own->start_memory(z); });
}
void check_states(const Lock& link) {
  if (const Stateful* own = link.stateful())
    check_numbers(link, "start_states()", own->n_states(), true, [&](auto s) { own->start_states(s); });
}

void check_spans(const Lock& link, const Inputs& in) {
  if (const int n = link.n_own_states(); n > 0)
    check_numbers(link, "state_rates()", n, true, [&](auto s) { link.stateful()->state_rates(in, s); });
  if (const int n = link.n_own_memory(); n > 0)
    check_numbers(link, "accept_step()", n, false, [&](auto z) { link.remembering()->accept_step(in, z); });
}

void check_force(const Force& force, const Inputs& in, int n_slots) {
  // Extra slots beyond the last, in which a misplaced force shows.
  constexpr int kBeyond = 16;
  std::vector<Motion> motions(in.motions.begin(), in.motions.end());
  motions.resize(motions.size() + kBeyond);
  Inputs at = in;
  at.motions = motions;
  VecX f = VecX::Zero(6 * (n_slots + kBeyond));
  WrenchSum sum(at.motions, f);
  if (!succeeds([&] { force.apply(at, sum); })) return;
  if (!f.tail(6 * kBeyond).isZero(0))
    reject_writes(force, "acts on a slot that does not exist; take it from a marker (marker.body->slot), after setup");
}

void check_slots(const Lock& link, int n_slots) {
  const SlotList& on = link.slots();
  if (on.n < 1 || on.n > kMaxSlots)
    reject_writes(link, "connects " + std::to_string(on.n) + " moving bodies; a joint connects 1 to " +
                            std::to_string(kMaxSlots) + ": add their slots in setup()");
  for (int i = 0; i < on.n; ++i)
    if (on[i] < 0 || on[i] >= n_slots)
      reject_writes(link, "uses slot " + std::to_string(on[i]) + " of " + std::to_string(n_slots) +
                              "; take it from a marker (marker.body->slot), in setup()");
}

}  // namespace

void check_writes(const System& system) {
  const auto foreign = [](const auto& things) {
    return std::any_of(things.begin(), things.end(), [](const auto& thing) { return !ours(thing->origin()); });
  };
  if (!foreign(system.links()) && !foreign(system.forces())) return;
  for (const auto& link : system.links())
    if (!system.merged(*link) && !ours(link->origin())) {
      check_slots(*link, system.n_slots());
      check_states(*link), check_memory(*link);
    }
  for (const auto& force : system.forces())
    if (!ours(force->origin())) check_memory(*force);

  State state;
  std::vector<Motion> motions;
  if (!succeeds([&] { state = system.start(); })) return;
  passes::motions(system, state, motions);
  const auto numbers = [](const VecX& x) {
    return std::span<const double>(x.data(), static_cast<std::size_t>(x.size()));
  };
  const Inputs in{state.t, motions, numbers(state.s), numbers(state.z)};

  RowTable table;
  passes::lay_out(system, std::vector<bool>(system.links().size(), true), table);
  for (const RowRun& run : table.runs) {
    std::vector<const Lock*> links;
    for (int k = 0; k < run.n; ++k) links.push_back(system.links()[table.entries[run.first_entry + k].link].get());
    if (ours(links.front()->origin())) continue;
    const RowEntry& e = table.entries[run.first_entry];
    const Lock& first = *links.front();
    const bool in_space = run.in_parts || (e.plane && !run.in_plane);
    const RowShape shape = in_space ? first.shape() : e.shape();
    for (std::size_t k = 0; k < links.size(); k += kAtOnce)
      check_links(Group(links).subspan(k, std::min(kAtOnce, links.size() - k)), shape, in, run.in_plane);
    for (const Lock* link : links) check_spans(*link, in);
  }
  for (const auto& force : system.forces())
    if (!ours(force->origin())) check_force(*force, in, system.n_slots());
}

}  // namespace lockstep
