// SPDX-License-Identifier: BSD-3-Clause
// Links from functions: one pair of markers, or several joints.
#pragma once

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/lock.h>
#include <lockstep/author/params.h>
#include <lockstep/detail/phi_function.h>
#include <lockstep/error.h>

namespace lockstep {

// PhiCoupling: a link from functions of two or three pairs of markers, phi(y1, y2, y3, t) = 0 (theory, (7.3)): gears,
// belts, differentials. The joints of the pairs are separate links.
//
//   struct Mesh {
//     double r1, r2;
//     static constexpr int kPairs = 2;
//     static constexpr Reads kReads = Reads::rotation;
//     static constexpr bool kCountsTurns = true;
//     template <class T> T operator()(const LockCoords<T>& a, const LockCoords<T>& b) const {
//       return r1 * a.angle_z() + r2 * b.angle_z();
//     }
//   };
//   using Gear = PhiCoupling<Mesh>;

/// The name of a coupling and its pairs of markers, those of a attachment or of joints (across).
struct CoupledPairs {
  std::string name;                                            ///< of the coupling
  std::vector<std::pair<const Marker*, const Marker*>> pairs;  ///< P before S

  /// Without pairs yet.
  explicit CoupledPairs(std::string of) : name(std::move(of)) {}
  /// The name and the pairs of a attachment.
  CoupledPairs(const Attachment& attachment)
      : name(attachment.name),
        pairs(attachment.pairs.begin(), attachment.pairs.end()) {}  // NOLINT: a attachment is one
  /// P of pair k. Throws ModelError: it is not given.
  const Marker& p(std::size_t k) const {
    return Attachment::given(name, k < pairs.size() ? pairs[k].first : nullptr, "p", k);
  }
  /// S of pair k. Throws ModelError: it is not given.
  const Marker& s(std::size_t k) const {
    return Attachment::given(name, k < pairs.size() ? pairs[k].second : nullptr, "s", k);
  }
};

/// The first pair of each of these joints: system.add(std::make_unique<Gear>(across("mesh", {one, two}), 2.0)).
inline CoupledPairs across(std::string name, std::initializer_list<std::reference_wrapper<const Lock>> joints) {
  CoupledPairs coupled(std::move(name));
  for (const Lock& joint : joints) coupled.pairs.push_back(joint.pairs().front());
  return coupled;
}

/// A link whose rows are those of a function phi of two or three pairs of markers. A derived class adds type() and, for
/// scenes, info() and make(). PhiTraits lists what phi may define.
template <class Phi>
class PhiCoupling : public Lock, public Driven, public Remembering, public TangentFormula {
  using Function = PhiFunction<Phi>;
  using Traits = PhiTraits<Phi>;

 public:
  /// Of exactly kPairs pairs. Throws ModelError: a pair that is missing, too many or given twice, a pair on one body,
  /// more than kMaxSlots bodies.
  PhiCoupling(const CoupledPairs& coupled, Phi phi);

  const Phi& phi() const { return function_.phi(); }  ///< the function
  /// The pairs that it couples.
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override {
    return {function_.pairs().begin(), function_.pairs().end()};
  }
  /// Rows of phi.
  void gather(Group links, const Inputs& in, RowSpan out) const override;

  /// By what phi and the markers' laws say of themselves.
  bool stays_in_plane(Plane plane) const override;

  /// This.
  const TangentFormula* tangent_formula() const override { return this; }
  /// (9.12) From the second derivatives of phi.
  void tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const override;

  /// This.
  const Driven* driven() const override { return this; }
  /// Of the markers' laws and of those in phi.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// Of the laws in phi.
  std::string diagnose(double t) const override;

  /// Of each pair whose turns phi counts.
  void count_angles(AngleCounter& counter) override { function_.count_angles(counter, unilateral() == nullptr); }

  /// This where phi has a memory, else null.
  const Remembering* remembering() const override { return Function::kMemory > 0 ? this : nullptr; }
  /// kMemory of phi.
  int n_memory() const override { return Function::kMemory; }
  /// What phi.reset() writes.
  void start_memory(std::span<double> z) const override;
  /// What phi.accept_step() writes.
  void accept_step(const Inputs& in, std::span<double> z) const override;

 protected:
  /// Rows of phi. Throws ModelError: no body can move, a turn of a particle is read, or phi refuses the start.
  RowPlan plan_rows() override;
  /// phi with its pairs, for channels of a derived class.
  const Function& function() const { return function_; }
  /// Its numbers in State::z at these inputs.
  const double* memory(const Inputs& in) const { return in.z.data() + first_memory(); }

 private:
  static typename Function::Pairs pairs_of(const CoupledPairs& attachment);

  Function function_;
};

// Defined outside of the class: files do not compile these again for a function that is declared `extern template`.

template <class Phi>
PhiCoupling<Phi>::PhiCoupling(const CoupledPairs& coupled, Phi phi)
    : Lock(coupled.name), function_(std::move(phi), pairs_of(coupled)) {}

template <class Phi>
void PhiCoupling<Phi>::gather(Group links, const Inputs& in, RowSpan out) const {
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& link = static_cast<const PhiCoupling&>(*links[i]);
    link.function_.fill(in, link.memory(in), link.slots(), 0, out.lane(i));
  }
}

template <class Phi>
void PhiCoupling<Phi>::tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const {
  function_.tangent(in, memory(in), lambda.data(), out);
}

template <class Phi>
bool PhiCoupling<Phi>::stays_in_plane(Plane plane) const {
  return Traits::kStaysInPlane && std::ranges::all_of(function_.pairs(), [&](const auto& pair) {
           return MarkerFrame(*pair.first).stays_in_plane(plane) && MarkerFrame(*pair.second).stays_in_plane(plane);
         });
}

template <class Phi>
void PhiCoupling<Phi>::breakpoints(double t0, double t1, std::vector<double>& out) const {
  for (const auto& [p, s] : function_.pairs())
    MarkerFrame(*p).breakpoints(t0, t1, out), MarkerFrame(*s).breakpoints(t0, t1, out);
  function_.breakpoints(t0, t1, out);
}

template <class Phi>
std::string PhiCoupling<Phi>::diagnose(double t) const {
  return function_.diagnose(t);
}

template <class Phi>
void PhiCoupling<Phi>::start_memory(std::span<double> z) const {
  function_.start_memory(z);
}

template <class Phi>
void PhiCoupling<Phi>::accept_step(const Inputs& in, std::span<double> z) const {
  function_.accept_step(in, z);
}

template <class Phi>
RowPlan PhiCoupling<Phi>::plan_rows() {
  function_.setup(name());
  RowPlan plan;
  function_.add_slots(plan.slots);
  if (plan.slots.n == 0)
    throw ModelError("link '" + name() + "': none of the bodies that it couples can move; couple a moving one");
  for (int k = 0; k < Function::kRows; ++k) plan.add(Traits::row(k));
  return plan;
}

template <class Phi>
typename PhiCoupling<Phi>::Function::Pairs PhiCoupling<Phi>::pairs_of(const CoupledPairs& attachment) {
  typename Function::Pairs pairs;
  std::vector<const Body*> seen;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    pairs[k] = {&attachment.p(k), &attachment.s(k)};
    for (std::size_t j = 0; j < k; ++j)
      if (pairs[j] == pairs[k])
        throw ModelError("link '" + attachment.name + "': pairs " + std::to_string(j + 1) + " and " +
                         std::to_string(k + 1) + " are the same two markers; couple two different joints");
    for (const Marker* m : {pairs[k].first, pairs[k].second})
      if (std::find(seen.begin(), seen.end(), m->body) == seen.end()) seen.push_back(m->body);
    if (pairs[k].first->body == pairs[k].second->body)
      throw ModelError("link '" + attachment.name + "': both sides of pair " + std::to_string(k + 1) +
                       " are on body '" + pairs[k].first->body->name + "'; name two bodies");
  }
  if (attachment.pairs.size() > pairs.size())
    throw ModelError("link '" + attachment.name + "' takes " + std::to_string(pairs.size()) + " pairs, and " +
                     std::to_string(attachment.pairs.size()) + " are given; remove the others");
  if (seen.size() > kMaxSlots)
    throw ModelError("link '" + attachment.name + "' couples " + std::to_string(seen.size()) +
                     " bodies; a link touches " + std::to_string(kMaxSlots) +
                     " at most: measure its pairs from a common body");
  return pairs;
}

// PhiLock: a joint whose rows are those of a mask and those of functions of the relative coordinates, phi(y, t) = 0
// (theory, section 7). Jacobian, Ct, right side and geometric stiffness follow from those of the lock and the exact
// derivatives of phi; nobody writes a jacobian.
//
//   struct ScrewThread { double lead; template <class T> T operator()(const LockCoords<T>& y) const; ... };  // phi.h
//   using Screw = PhiLock<ScrewThread>;

/// A joint whose rows are those of a mask and its drives, as in MarkerLock, and those of a function phi. A derived
/// class adds type() and, for scenes, info() and make(). PhiTraits lists what phi may define.
template <class Phi>
class PhiLock : public MarkerLock, public Remembering {
  using Function = PhiFunction<Phi>;
  using Traits = PhiTraits<Phi>;

 public:
  /// Of a function of one pair. Throws ModelError: both markers are on one body.
  PhiLock(std::string name, Marker& p, Marker& s, Mask mask, Phi phi);

  const Phi& phi() const { return function_.phi(); }  ///< the function

  /// Rows of the mask and the drives, then of phi.
  void gather(Group links, const Inputs& in, RowSpan out) const override;
  /// That of the lock and (9.11) that of phi.
  void tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const override;

  /// By what phi and all laws say of themselves.
  bool stays_in_plane(Plane plane) const override;

  /// Of the lock's laws and of those in phi.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// Of the lock's laws and of those in phi.
  std::string diagnose(double t) const override;

  /// Of each pair whose turns phi counts.
  void count_angles(AngleCounter& counter) override { function_.count_angles(counter, unilateral() == nullptr); }

  /// This where phi has a memory, else null.
  const Remembering* remembering() const override { return Function::kMemory > 0 ? this : nullptr; }
  /// kMemory of phi.
  int n_memory() const override { return Function::kMemory; }
  /// What phi.reset() writes.
  void start_memory(std::span<double> z) const override;
  /// What phi.accept_step() writes.
  void accept_step(const Inputs& in, std::span<double> z) const override;

 protected:
  /// Rows of the lock, then of phi. A triple remains one if phi reads the rotation alone, which has no columns on v.
  /// Throws ModelError as MarkerLock does, and where phi refuses the start.
  RowPlan plan_rows() override;
  /// phi with its pair, for channels of a derived class.
  const Function& function() const { return function_; }
  /// Its numbers in State::z at these inputs.
  const double* memory(const Inputs& in) const { return in.z.data() + first_memory(); }

 private:
  Function function_;
  int first_ = 0;  // first row of the function
};

// Defined outside of the class, as those of PhiCoupling.

template <class Phi>
PhiLock<Phi>::PhiLock(std::string name, Marker& p, Marker& s, Mask mask, Phi phi)
    : MarkerLock(std::move(name), p, s, mask), function_(std::move(phi), {{{&p, &s}}}) {
  static_assert(Function::kPairs == 1, "a function of several pairs makes a PhiCoupling");
}

template <class Phi>
void PhiLock<Phi>::gather(Group links, const Inputs& in, RowSpan out) const {
  if (overlaps(rows(), Mask::all)) MarkerLock::gather(links, in, out);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& link = static_cast<const PhiLock&>(*links[i]);
    link.function_.fill(in, link.memory(in), link.slots(), link.first_, out.lane(i));
  }
}

template <class Phi>
void PhiLock<Phi>::tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const {
  MarkerLock::tangent(in, lambda, out);
  function_.tangent(in, memory(in), lambda.data() + first_, out);
}

template <class Phi>
bool PhiLock<Phi>::stays_in_plane(Plane plane) const {
  return Traits::kStaysInPlane && laws_stay_in_plane(plane);
}

template <class Phi>
void PhiLock<Phi>::breakpoints(double t0, double t1, std::vector<double>& out) const {
  MarkerLock::breakpoints(t0, t1, out);
  function_.breakpoints(t0, t1, out);
}

template <class Phi>
std::string PhiLock<Phi>::diagnose(double t) const {
  const std::string law = MarkerLock::diagnose(t);
  return law.empty() ? function_.diagnose(t) : law;
}

template <class Phi>
void PhiLock<Phi>::start_memory(std::span<double> z) const {
  function_.start_memory(z);
}

template <class Phi>
void PhiLock<Phi>::accept_step(const Inputs& in, std::span<double> z) const {
  function_.accept_step(in, z);
}

template <class Phi>
RowPlan PhiLock<Phi>::plan_rows() {
  RowPlan plan = MarkerLock::plan_rows();
  first_ = static_cast<int>(plan.rows.size());
  function_.setup(name());
  for (int k = 0; k < Function::kRows; ++k)
    Traits::reads(0, Reads::translation) ? plan.add(Traits::row(k)) : plan.add_turning(Traits::row(k));
  return plan;
}

}  // namespace lockstep
