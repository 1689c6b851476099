// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/links/formula_joint.h"

#include <algorithm>
#include <array>

#include <lockstep/error.h>
#include "framework/mechanism/expression/dimensions.h"
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/function.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

using expression::FormulaFunction;

// The variables of the formulas, in the order of FormulaRows::on(); those after kTime read the rotation, the last one
// counts turns.
const std::vector<std::string> kVariables = {"x", "y", "z", "t", "e0", "e1", "e2", "e3", "rz"};
constexpr int kTime = 3, kRotation = 4, kTurn = 8;

/// phi = formulas of the relative coordinates and the time.
template <int n, Reads reads, bool counts>
struct FormulaRows : PhiHooks {
  std::array<FormulaFunction, std::size_t(n)> formulas;
  static constexpr PhiSpec spec{.rows = n, .reads = reads, .counts_turns = counts};

  template <class T>
  auto operator()(const LockCoords<T>& y) const -> std::conditional_t<n == 1, T, std::array<T, std::size_t(n)>> {
    std::array<T, 9> v;
    v[0] = y.x, v[1] = y.y, v[2] = y.z, v[3] = y.t;
    if constexpr (reads == Reads::both) v[4] = y.e0, v[5] = y.e1, v[6] = y.e2, v[7] = y.e3;
    if constexpr (counts) v[8] = y.angle_z();
    const std::span<const T> all(v);
    if constexpr (n == 1) {
      return formulas[0](all);
    } else {
      std::array<T, std::size_t(n)> rows;
      for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = formulas[k](all);
      return rows;
    }
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const FormulaFunction& f : formulas) f.breakpoints(kTime, t0, t1, out);
  }
};

template <class Phi>
class FormulaLink final : public PhiLock<Phi> {
 public:
  using PhiLock<Phi>::PhiLock;
  std::string_view type() const override { return "function"; }
  // In a plane only translations along it and turns about its normal change; all other derivatives must be zero.
  bool stays_in_plane(Plane plane) const override {
    const Vec3 P = MarkerFrame(this->p()).A0.row(plane.n), S = MarkerFrame(this->s()).A0.row(plane.n);
    const auto stays = [&](int k) {
      if (k < kTime) return axis_stays_in_plane(Axis(k), S);
      if (k == kTime) return true;
      const int axis = k == kTurn ? 3 : k - kRotation;  // 0: none, the scalar part
      return (P - S).norm() <= kParallel && (axis == 0 || axis_stays_in_plane(Axis(2 + axis), S));
    };
    for (int k = 0; k <= kTurn; ++k)
      for (const FormulaFunction& f : this->phi().formulas)
        if (f.reads(k) && !stays(k)) return false;
    return this->laws_stay_in_plane(plane);
  }
};

// Whether one of them reads one of the variables from one on, before another.
bool read_any(std::span<const FormulaFunction> formulas, int from, int to) {
  for (int k = from; k < to; ++k)
    for (const FormulaFunction& f : formulas)
      if (f.reads(k)) return true;
  return false;
}

template <int n, Reads reads, bool counts>
std::unique_ptr<Lock> link_of(const Attachment& a, Mask mask, const std::vector<FormulaFunction>& formulas) {
  FormulaRows<n, reads, counts> phi;
  std::copy_n(formulas.begin(), std::size_t(n), phi.formulas.begin());
  return std::make_unique<FormulaLink<FormulaRows<n, reads, counts>>>(a.name, a.p(), a.s(), mask, std::move(phi));
}

template <int n>
std::unique_ptr<Lock> link_of(const Attachment& a, Mask mask, const std::vector<FormulaFunction>& formulas) {
  if (read_any(formulas, kTurn, kTurn + 1)) return link_of<n, Reads::both, true>(a, mask, formulas);
  if (read_any(formulas, kRotation, kTurn)) return link_of<n, Reads::both, false>(a, mask, formulas);
  return link_of<n, Reads::translation, false>(a, mask, formulas);
}

// The quaternion is of pure numbers.
std::vector<expression::MeasuredVariable> measured_variables() {
  std::vector<expression::MeasuredVariable> all;
  for (std::size_t k = 0; k < kVariables.size(); ++k) {
    const int i = static_cast<int>(k);
    const Unit unit = i < kTime ? Unit::length : i == kTime ? Unit::time : i == kTurn ? Unit::angle : Unit::none;
    all.push_back({kVariables[k], dimension_of(unit)});
  }
  return all;
}

FormulaFunction read_formula(const Value& v, const std::string& place,
                             const std::vector<expression::Constant>& constants) {
  FormulaFunction f;
  try {
    f = FormulaFunction(read_text(v, place), kVariables, constants);
    expression::check_dimensions(f.text(), measured_variables(), constants, std::nullopt);
  } catch (const ModelError& error) {
    refuse(v.where, place, error.what());
  }
  if (!read_any({&f, 1}, 0, kTime) && !read_any({&f, 1}, kRotation, kTurn + 1))
    refuse(v.where, place, "it uses no coordinate, so it constrains nothing; known: x, y, z, e0, e1, e2, e3, rz");
  return f;
}

}  // namespace

TypeInfo FormulaJoint::info() {
  return {
      "function",
      "formulas of the pose of P relative to S, each held at zero; degrees of freedom left: 6 less the formulas and "
      "mask",
      {{"phi", Form::any, Unit::none, kRequired,
        "formula, or list of up to 3: of x, y, z (m), e0 ... e3 (quaternion), rz (rad, counted) and t"},
       {"mask", Form::text, Unit::none, "", "further constraints, as of a lock: words of x y z e1 e2 e3"},
       expression::constants_key()}};
}

std::unique_ptr<Lock> FormulaJoint::make(const Attachment& attachment, const Params& p) {
  const std::vector<expression::Constant> constants = expression::read_constants(p, "parameters");
  const Value& phi = p.value("phi");
  const std::string place = part_of(p.owner(), "phi");
  std::vector<FormulaFunction> formulas;
  if (phi.list() == nullptr)
    formulas.push_back(read_formula(phi, place, constants));
  else
    for (std::size_t i = 0; i < phi.list()->size(); ++i)
      formulas.push_back(read_formula((*phi.list())[i], item(place, i), constants));
  const std::string words = p.text("mask");
  const Mask mask = words.empty() ? Mask::none : mask_from(words);
  if (formulas.size() == 1) return link_of<1>(attachment, mask, formulas);
  if (formulas.size() == 2) return link_of<2>(attachment, mask, formulas);
  if (formulas.size() == 3) return link_of<3>(attachment, mask, formulas);
  p.refuse("phi",
           "it has " + std::to_string(formulas.size()) + " formulas; give 1, 2 or 3, and another joint for more");
}

}  // namespace lockstep
