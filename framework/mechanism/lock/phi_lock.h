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
class PhiLock : public MarkerLock {
  using Function = PhiFunction<Phi>;
  using Traits = PhiTraits<Phi>;

 public:
  PhiLock(std::string name, Marker& p, Marker& s, Mask mask, Phi phi)
      : MarkerLock(std::move(name), p, s, mask), function_(std::move(phi), {{{&p, &s}}}) {
    static_assert(Function::kPairs == 1, "a function of several pairs makes a PhiCoupling");
  }

  const Phi& phi() const { return function_.phi(); }
  int row_count() const override { return MarkerLock::row_count() + Function::kRows; }
  RowKind row_kind(int k) const override { return is_phi(k) ? Traits::kKind : MarkerLock::row_kind(k); }
  std::string row_name(int k) const override {
    return is_phi(k) ? Traits::row_name(k - MarkerLock::row_count()) : MarkerLock::row_name(k);
  }
  int drive_row(int k) const override { return is_phi(k) ? -1 : MarkerLock::drive_row(k); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    MarkerLock::breakpoints(t0, t1, out);
    function_.breakpoints(t0, t1, out);
  }
  std::string blame(double t) const override {
    const std::string law = MarkerLock::blame(t);
    return law.empty() ? function_.blame(t) : law;
  }

  void setup() override {
    MarkerLock::setup();
    function_.setup(name());
    slots_ = MarkerLock::slots();
  }

  void gather(Group links, const Inputs& in, RowSpan out) const override {
    if (any(rows(), Mask::all)) MarkerLock::gather(links, in, out);
    for (std::size_t i = 0; i < links.size(); ++i) {
      const auto& link = static_cast<const PhiLock&>(*links[i]);
      link.function_.fill(in, link.memory(in), link.slots_, link.MarkerLock::row_count(), out.lane(i));
    }
  }
  void tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const override {
    MarkerLock::tangent(in, lambda, out);
    function_.tangent(in, memory(in), lambda.data() + MarkerLock::row_count(), out);
  }

  /// A triple only beside functions of the turn alone: any other has columns on v.
  RowLayout layout() const override {
    return Traits::needs(0, Needs::translation) || !has(rows(), Mask::xyz) ? RowLayout::dense : RowLayout::triple;
  }

  int n_memory() const override { return Function::kMemory; }
  void start_memory(std::span<double> z) const override { function_.begin(z); }
  void accept(const Inputs& in, std::span<double> z) const override { function_.remember(in, z); }

 protected:
  const Function& function() const { return function_; }
  const double* memory(const Inputs& in) const { return in.z.data() + first_memory(); }

 private:
  bool is_phi(int k) const { return k >= MarkerLock::row_count(); }

  Function function_;
  SlotList slots_;
};

}  // namespace lockstep
