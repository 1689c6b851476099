// SPDX-License-Identifier: BSD-3-Clause
// Joints of a custom function: of one pair of markers, or between several joints.
#pragma once

#include <string>
#include <utility>

#include <lockstep/author/function_links.h>
#include <lockstep/author/params.h>
#include <lockstep/author/phi.h>
#include <lockstep/detail/phi_function.h>

namespace lockstep {

/// A joint whose rows are those of a mask and those of a function phi of one pair. A derived class adds type() and, for
/// scenes, info() and make(). PhiSpec lists the declarations of phi.
///
///     struct ScrewThread { double lead; template <class T> T operator()(const LockCoords<T>& y) const; ... };  // phi.h
///     using Screw = PhiLock<ScrewThread>;
template <class Phi>
class PhiLock : public FunctionLock {
 public:
  /// Throws ModelError: both markers are on one body.
  PhiLock(std::string name, Marker& p, Marker& s, Mask mask, Phi phi)
      : FunctionLock(std::move(name), p, s, mask, rows_of(std::move(phi))) {
    static_assert(Phi::spec.pairs == 1, "a function of several pairs makes a PhiCoupling");
  }
  const Phi& phi() const { return phi_of<Phi>(function()); }  ///< the function
};

/// A joint whose rows are those of a function phi of two or three pairs of markers. A derived class adds type() and,
/// for scenes, info() and make().
///
///     struct Mesh {
///       double r1, r2;
///       static constexpr PhiSpec spec{.pairs = 2, .reads = Reads::rotation, .counts_turns = true};
///       template <class T> T operator()(const LockCoords<T>& a, const LockCoords<T>& b) const {
///         return r1 * a.angle_z() + r2 * b.angle_z();
///       }
///     };
///     using Gear = PhiCoupling<Mesh>;
template <class Phi>
class PhiCoupling : public FunctionCoupling {
 public:
  /// Throws ModelError: a pair that is missing, too many or given twice, a pair on one body, more than kMaxSlots bodies.
  PhiCoupling(const CoupledPairs& coupled, Phi phi) : FunctionCoupling(coupled, rows_of(std::move(phi))) {}
  const Phi& phi() const { return phi_of<Phi>(function()); }  ///< the function
};

}  // namespace lockstep
