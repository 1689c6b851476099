// PhiLock: a joint from functions of the relative coordinates, phi(y, t) = 0, beside the mask's rows (theory, section
// 7). Constraint, rows, Ct, right side and geometric stiffness follow from the lock's own and phi's exact derivatives;
// nobody writes a jacobian.
//
//   struct ScrewThread { double lead; template <class T> T operator()(const LockCoords<T>& y) const; ... };  // phi.h
//   using Screw = PhiLock<ScrewThread>;
#pragma once

#include <string>

#include "framework/mechanism/lock/marker_lock.h"
#include "framework/mechanism/lock/phi_function.h"

namespace lockstep {

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
