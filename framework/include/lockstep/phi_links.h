// Links from functions: one pair of markers, or several joints.
#pragma once

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/lock.h>
#include <lockstep/params.h>
#include <lockstep/phi_function.h>

namespace lockstep {

// PhiCoupling: a link from functions of two or three pairs of markers, phi(y1, y2, y3, t) = 0 (theory, (7.3)): gears,
// belts, differentials. The pairs' own joints are links of their own.
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


/// The pairs of markers that a coupling takes, which it only reads: those of a site, or of joints (across).
struct CoupledPairs {
  std::string name;  ///< of the coupling
  std::vector<std::pair<const Marker*, const Marker*>> pairs;

  explicit CoupledPairs(std::string of) : name(std::move(of)) {}
  CoupledPairs(const Site& site)
      : name(site.name), pairs(site.pairs.begin(), site.pairs.end()) {}  // NOLINT: a site is one
  /// Of pair k; throw ModelError when the marker is not given.
  const Marker& p(std::size_t k) const {
    return Site::given(name, k < pairs.size() ? pairs[k].first : nullptr, "p", k);
  }
  const Marker& s(std::size_t k) const {
    return Site::given(name, k < pairs.size() ? pairs[k].second : nullptr, "s", k);
  }
};

/// The first pairs of these joints: sys.add(std::make_unique<Gear>(across("mesh", {one, two}), Gear::Settings{2.0})).
inline CoupledPairs across(std::string name, std::initializer_list<std::reference_wrapper<const Lock>> joints) {
  CoupledPairs coupled(std::move(name));
  for (const Lock& joint : joints) coupled.pairs.push_back(joint.pairs().front());
  return coupled;
}

/// Rows: those of phi. Derive, give it a type() and, for files, info() with the number of pairs, and make(). What phi
/// may say about itself: PhiTraits.
template <class Phi>
class PhiCoupling : public Lock, public Driven, public Remembering, public TangentFormula {
  using Function = PhiFunction<Phi>;
  using Traits = PhiTraits<Phi>;

 public:
  /// Takes kPairs pairs, P before S. Throws ModelError when one is missing.
  PhiCoupling(const CoupledPairs& coupled, Phi phi)
      : Lock(coupled.name), function_(std::move(phi), pairs_of(coupled)) {}

  const Phi& phi() const { return function_.phi(); }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override {
    return {function_.pairs().begin(), function_.pairs().end()};
  }
  void gather(Group links, const Inputs& in, RowSpan out) const override {
    for (std::size_t i = 0; i < links.size(); ++i) {
      const auto& link = static_cast<const PhiCoupling&>(*links[i]);
      link.function_.fill(in, link.memory(in), link.slots(), 0, out.lane(i));
    }
  }

  const TangentFormula* tangent_formula() const override { return this; }
  void tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const override {
    function_.tangent(in, memory(in), lambda.data(), out);
  }

  const Driven* driven() const override { return this; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const auto& [p, s] : function_.pairs())
      MarkerFrame(*p).breakpoints(t0, t1, out), MarkerFrame(*s).breakpoints(t0, t1, out);
    function_.breakpoints(t0, t1, out);
  }
  std::string diagnose(double t) const override { return function_.diagnose(t); }

  const Remembering* remembering() const override { return Function::kMemory > 0 ? this : nullptr; }
  int n_memory() const override { return Function::kMemory; }
  void start_memory(std::span<double> z) const override { function_.start_memory(z); }
  void accept_step(const Inputs& in, std::span<double> z) const override { function_.accept_step(in, z); }

 protected:
  RowPlan plan_rows() override {
    function_.setup(name());
    RowPlan plan;
    function_.add_slots(plan.slots);
    if (plan.slots.n == 0)
      throw ModelError("link '" + name() + "': none of the bodies that it couples can move; couple a moving one");
    for (int k = 0; k < Function::kRows; ++k) plan.add(Traits::row(k));
    return plan;
  }
  const Function& function() const { return function_; }
  const double* memory(const Inputs& in) const { return in.z.data() + first_memory(); }

 private:
  static typename Function::Pairs pairs_of(const CoupledPairs& site) {
    typename Function::Pairs pairs;
    std::vector<const Body*> seen;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      pairs[k] = {&site.p(k), &site.s(k)};
      for (std::size_t j = 0; j < k; ++j)
        if (pairs[j] == pairs[k])
          throw ModelError("link '" + site.name + "': pairs " + std::to_string(j + 1) + " and " +
                           std::to_string(k + 1) + " are the same two markers; couple two different joints");
      for (const Marker* m : {pairs[k].first, pairs[k].second})
        if (std::find(seen.begin(), seen.end(), m->body) == seen.end()) seen.push_back(m->body);
      if (pairs[k].first->body == pairs[k].second->body)
        throw ModelError("link '" + site.name + "': both sides of pair " + std::to_string(k + 1) + " are on body '" +
                         pairs[k].first->body->name + "'; name two bodies");
    }
    if (site.pairs.size() > pairs.size())
      throw ModelError("link '" + site.name + "' takes " + std::to_string(pairs.size()) + " pairs, and " +
                       std::to_string(site.pairs.size()) + " are given; remove the others");
    if (seen.size() > kMaxSlots)
      throw ModelError("link '" + site.name + "' couples " + std::to_string(seen.size()) + " bodies; a link touches " +
                       std::to_string(kMaxSlots) + " at most: measure its pairs from a common body");
    return pairs;
  }

  Function function_;
};


// PhiLock: a joint from functions of the relative coordinates, phi(y, t) = 0, beside the mask's rows (theory, section
// 7). Constraint, rows, Ct, right side and geometric stiffness follow from the lock's own and phi's exact derivatives;
// nobody writes a jacobian.
//
//   struct ScrewThread { double lead; template <class T> T operator()(const LockCoords<T>& y) const; ... };  // phi.h
//   using Screw = PhiLock<ScrewThread>;


/// Rows: those of the mask and its drives as in MarkerLock, then phi. Derive, give it a type() and, for files, info()
/// and make(). What phi may say about itself: PhiTraits.
template <class Phi>
class PhiLock : public MarkerLock, public Remembering {
  using Function = PhiFunction<Phi>;
  using Traits = PhiTraits<Phi>;

 public:
  PhiLock(std::string name, Marker& p, Marker& s, Mask mask, Phi phi)
      : MarkerLock(std::move(name), p, s, mask), function_(std::move(phi), {{{&p, &s}}}) {
    static_assert(Function::kPairs == 1, "a function of several pairs makes a PhiCoupling");
  }

  const Phi& phi() const { return function_.phi(); }

  void gather(Group links, const Inputs& in, RowSpan out) const override {
    if (any(rows(), Mask::all)) MarkerLock::gather(links, in, out);
    for (std::size_t i = 0; i < links.size(); ++i) {
      const auto& link = static_cast<const PhiLock&>(*links[i]);
      link.function_.fill(in, link.memory(in), link.slots(), link.first_, out.lane(i));
    }
  }
  void tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const override {
    MarkerLock::tangent(in, lambda, out);
    function_.tangent(in, memory(in), lambda.data() + first_, out);
  }

  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    MarkerLock::breakpoints(t0, t1, out);
    function_.breakpoints(t0, t1, out);
  }
  std::string diagnose(double t) const override {
    const std::string law = MarkerLock::diagnose(t);
    return law.empty() ? function_.diagnose(t) : law;
  }

  const Remembering* remembering() const override { return Function::kMemory > 0 ? this : nullptr; }
  int n_memory() const override { return Function::kMemory; }
  void start_memory(std::span<double> z) const override { function_.start_memory(z); }
  void accept_step(const Inputs& in, std::span<double> z) const override { function_.accept_step(in, z); }

 protected:
  /// A triple only beside functions of the turn alone: any other has columns on v.
  RowPlan plan_rows() override {
    RowPlan plan = MarkerLock::plan_rows();
    first_ = static_cast<int>(plan.rows.size());
    function_.setup(name());
    for (int k = 0; k < Function::kRows; ++k)
      Traits::reads(0, Reads::translation) ? plan.add(Traits::row(k)) : plan.add_turning(Traits::row(k));
    return plan;
  }
  const Function& function() const { return function_; }
  const double* memory(const Inputs& in) const { return in.z.data() + first_memory(); }

 private:
  Function function_;
  int first_ = 0;  // row of the function
};

}  // namespace lockstep
