// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/function_links.h>

#include <algorithm>

#include <lockstep/author/params.h>
#include <lockstep/detail/phi_rows.h>
#include <lockstep/error.h>

namespace lockstep {

LinkFunction::LinkFunction(std::unique_ptr<PhiRows> function) : function_(std::move(function)) {}
LinkFunction::~LinkFunction() = default;
int LinkFunction::n_memory() const { return function_->spec().memory; }
void LinkFunction::start_memory(std::span<double> z) const { function_->start_memory(z); }
void LinkFunction::accept_step(const Inputs& in, std::span<double> z) const { function_->accept_step(in, z); }

FunctionLock::FunctionLock(std::string name, Marker& p, Marker& s, Mask mask, std::unique_ptr<PhiRows> function)
    : MarkerLock(std::move(name), p, s, mask), LinkFunction(std::move(function)) {
  function_->take({{&p, &s}});
}

void FunctionLock::gather(Group links, const Inputs& in, RowSpan out) const {
  if (overlaps(rows(), Mask::all)) MarkerLock::gather(links, in, out);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& link = static_cast<const FunctionLock&>(*links[i]);
    link.function_->fill(in, link.memory(in), link.slots(), link.first_, out.lane(i));
  }
}

void FunctionLock::tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const {
  MarkerLock::tangent(in, lambda, out);
  function_->tangent(in, memory(in), lambda.data() + first_, out);
}

bool FunctionLock::stays_in_plane(Plane plane) const {
  return function_->spec().stays_in_plane && laws_stay_in_plane(plane);
}

void FunctionLock::breakpoints(double t0, double t1, std::vector<double>& out) const {
  MarkerLock::breakpoints(t0, t1, out);
  function_->hooks().breakpoints(t0, t1, out);
}

std::string FunctionLock::diagnose(double t) const {
  const std::string law = MarkerLock::diagnose(t);
  return law.empty() ? function_->hooks().diagnose(t) : law;
}

void FunctionLock::count_angles(AngleCounter& counter) { function_->count_angles(counter, unilateral() == nullptr); }
const Remembering* FunctionLock::remembering() const { return n_memory() > 0 ? this : nullptr; }

RowPlan FunctionLock::plan_rows() {
  RowPlan plan = MarkerLock::plan_rows();
  first_ = static_cast<int>(plan.rows.size());
  function_->setup(name());
  for (int k = 0; k < function_->spec().rows; ++k)
    function_->spec().reads_of(0, Reads::translation) ? plan.add(function_->row(k))
                                                      : plan.add_turning(function_->row(k));
  return plan;
}

CoupledPairs::CoupledPairs(const Attachment& attachment)
    : name(attachment.name), pairs(attachment.pairs.begin(), attachment.pairs.end()) {}

CoupledPairs across(std::string name, std::initializer_list<std::reference_wrapper<const Lock>> joints) {
  CoupledPairs coupled(std::move(name));
  for (const Lock& joint : joints) coupled.pairs.push_back(joint.pairs().front());
  return coupled;
}

namespace {

// The first n pairs, as a coupling takes them.
std::vector<MarkerPair> checked_pairs(const CoupledPairs& coupled, std::size_t n) {
  std::vector<MarkerPair> pairs;
  std::vector<const Body*> seen;
  for (std::size_t k = 0; k < n; ++k) {
    const MarkerPair given = k < coupled.pairs.size() ? coupled.pairs[k] : MarkerPair{};
    const MarkerPair pair{&Attachment::given(coupled.name, given.first, "p", k),
                          &Attachment::given(coupled.name, given.second, "s", k)};
    for (std::size_t j = 0; j < k; ++j)
      if (pairs[j] == pair)
        throw ModelError("joint '" + coupled.name + "': pairs " + std::to_string(j + 1) + " and " +
                         std::to_string(k + 1) + " are the same two markers; couple two different joints");
    for (const Marker* m : {pair.first, pair.second})
      if (std::find(seen.begin(), seen.end(), m->body) == seen.end()) seen.push_back(m->body);
    if (pair.first->body == pair.second->body)
      throw ModelError("joint '" + coupled.name + "': both sides of pair " + std::to_string(k + 1) + " are on body '" +
                       pair.first->body->name + "'; use two bodies");
    pairs.push_back(pair);
  }
  if (coupled.pairs.size() > n)
    throw ModelError("joint '" + coupled.name + "' takes " + std::to_string(n) + " pairs, but " +
                     std::to_string(coupled.pairs.size()) + " are given; remove the others");
  if (seen.size() > kMaxSlots)
    throw ModelError("joint '" + coupled.name + "' couples " + std::to_string(seen.size()) + " bodies; the limit is " +
                     std::to_string(kMaxSlots) + ": measure its pairs from a common body");
  return pairs;
}

}  // namespace

FunctionCoupling::FunctionCoupling(const CoupledPairs& coupled, std::unique_ptr<PhiRows> function)
    : Lock(coupled.name), LinkFunction(std::move(function)) {
  function_->take(checked_pairs(coupled, static_cast<std::size_t>(function_->spec().pairs)));
}

std::vector<MarkerPair> FunctionCoupling::pairs() const { return function_->pairs(); }

void FunctionCoupling::gather(Group links, const Inputs& in, RowSpan out) const {
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& link = static_cast<const FunctionCoupling&>(*links[i]);
    link.function_->fill(in, link.memory(in), link.slots(), 0, out.lane(i));
  }
}

void FunctionCoupling::tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const {
  function_->tangent(in, memory(in), lambda.data(), out);
}

bool FunctionCoupling::stays_in_plane(Plane plane) const {
  return function_->spec().stays_in_plane && std::ranges::all_of(function_->pairs(), [&](const MarkerPair& pair) {
           return MarkerFrame(*pair.first).stays_in_plane(plane) && MarkerFrame(*pair.second).stays_in_plane(plane);
         });
}

void FunctionCoupling::breakpoints(double t0, double t1, std::vector<double>& out) const {
  for (const auto& [p, s] : function_->pairs())
    MarkerFrame(*p).breakpoints(t0, t1, out), MarkerFrame(*s).breakpoints(t0, t1, out);
  function_->hooks().breakpoints(t0, t1, out);
}

std::string FunctionCoupling::diagnose(double t) const { return function_->hooks().diagnose(t); }
void FunctionCoupling::count_angles(AngleCounter& counter) {
  function_->count_angles(counter, unilateral() == nullptr);
}
const Remembering* FunctionCoupling::remembering() const { return n_memory() > 0 ? this : nullptr; }

RowPlan FunctionCoupling::plan_rows() {
  function_->setup(name());
  RowPlan plan;
  function_->add_slots(plan.slots);
  if (plan.slots.n == 0)
    throw ModelError("joint '" + name() + "': none of the bodies that it couples can move; couple a moving one");
  for (int k = 0; k < function_->spec().rows; ++k) plan.add(function_->row(k));
  return plan;
}

}  // namespace lockstep
