// SPDX-License-Identifier: BSD-3-Clause
// Joints whose rows are those of a function of relative coordinates.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/lock.h>

namespace lockstep {

class PhiRows;
struct Attachment;

/// The function of a joint, with its memory.
class LOCKSTEP_API LinkFunction : public Remembering {
 public:
  const PhiRows& function() const { return *function_; }  ///< rows of phi
  int n_memory() const override;                          ///< that of phi
  /// What PhiHooks::reset writes.
  void start_memory(std::span<double> z) const override;
  /// What PhiHooks::accept_step writes.
  void accept_step(const Inputs& in, std::span<double> z) const override;

 protected:
  /// Takes the rows of phi.
  explicit LinkFunction(std::unique_ptr<PhiRows> function);
  ~LinkFunction();
  std::unique_ptr<PhiRows> function_;  ///< rows of phi
};

/// A joint whose rows are those of a mask and its drives, as in MarkerLock, and those of a function of the relative
/// coordinates, phi(y, t) = 0 (theory, section 7). Jacobian, Ct, right-hand side and geometric stiffness follow from
/// those of the lock and the exact derivatives of phi.
class LOCKSTEP_API FunctionLock : public MarkerLock, public LinkFunction {
 public:
  /// Rows of the mask and the drives, then of phi.
  void gather(Group links, const Inputs& in, RowSpan out) const override;
  /// That of the lock and (9.11) that of phi.
  void tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const override;
  /// As declared by phi and all laws.
  bool stays_in_plane(Plane plane) const override;
  /// Of the lock's laws and of those in phi.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// Of the lock's laws and of those in phi.
  std::string diagnose(double t) const override;
  /// For each pair whose revolutions phi counts.
  void count_angles(AngleCounter& counter) override;
  /// This if phi has a memory, else null.
  const Remembering* remembering() const override;

 protected:
  /// Of a function of one pair. Throws ModelError: both markers are on one body.
  FunctionLock(std::string name, Marker& p, Marker& s, Mask mask, std::unique_ptr<PhiRows> function);
  /// Rows of the lock, then of phi. A triple remains one if phi reads the rotation alone, which has no columns on v.
  /// Throws ModelError as MarkerLock does, and if phi rejects the start.
  RowPlan plan_rows() override;
  /// Its numbers in State::z at these inputs.
  const double* memory(const Inputs& in) const { return in.z.data() + first_memory(); }

 private:
  int first_ = 0;  // first row of the function
};

/// The name of a coupling and its pairs of markers, those of an attachment or of joints (across).
struct LOCKSTEP_API CoupledPairs {
  std::string name;                                            ///< of the coupling
  std::vector<std::pair<const Marker*, const Marker*>> pairs;  ///< P before S

  /// Without pairs yet.
  explicit CoupledPairs(std::string of) : name(std::move(of)) {}
  /// The name and the pairs of an attachment.
  CoupledPairs(const Attachment& attachment);  // NOLINT: an attachment is one
};

/// The first pair of each of these joints: system.add(std::make_unique<Gear>(across("mesh", {one, two}), 2.0)).
LOCKSTEP_API CoupledPairs across(std::string name, std::initializer_list<std::reference_wrapper<const Lock>> joints);

/// A joint whose rows are those of a function of two or three pairs of markers, phi(y1, y2, y3, t) = 0 (theory, (7.3)):
/// gears, belts, differentials. The joints of the pairs are separate joints.
class LOCKSTEP_API FunctionCoupling : public Lock, public LinkFunction, public Driven, public TangentFormula {
 public:
  /// The pairs that it couples.
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override;
  /// Rows of phi.
  void gather(Group links, const Inputs& in, RowSpan out) const override;
  /// As declared by phi and the laws of the markers.
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
  /// For each pair whose revolutions phi counts.
  void count_angles(AngleCounter& counter) override;
  /// This if phi has a memory, else null.
  const Remembering* remembering() const override;

 protected:
  /// Throws ModelError: a pair that is missing, too many or given twice, a pair on one body, more than kMaxSlots bodies.
  FunctionCoupling(const CoupledPairs& coupled, std::unique_ptr<PhiRows> function);
  /// Rows of phi. Throws ModelError: no body can move, a rotation of a particle is read, or phi rejects the start.
  RowPlan plan_rows() override;
  /// Its numbers in State::z at these inputs.
  const double* memory(const Inputs& in) const { return in.z.data() + first_memory(); }
};

}  // namespace lockstep
