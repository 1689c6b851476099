// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/links/formula_joint.h"

#include <algorithm>
#include <array>

#include <lockstep/error.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/function.h"
#include "framework/mechanism/expression/scope.h"
#include "framework/mechanism/lock/coordinate.h"
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

// In a plane only translations along it and turns about its normal change; all other derivatives must be zero.
bool stays(int variable, const Marker& p, const Marker& s, Plane plane) {
  const Vec3 P = MarkerFrame(p).A0.row(plane.n), S = MarkerFrame(s).A0.row(plane.n);
  if (variable < kTime) return axis_stays_in_plane(Axis(variable), S);
  if (variable == kTime) return true;
  const int axis = variable == kTurn ? 3 : variable - kRotation;  // 0: none, the scalar part
  return (P - S).norm() <= kParallel && (axis == 0 || axis_stays_in_plane(Axis(2 + axis), S));
}

template <class Phi>
class FormulaLink final : public PhiLock<Phi> {
 public:
  using PhiLock<Phi>::PhiLock;
  std::string_view type() const override { return "function"; }
  bool stays_in_plane(Plane plane) const override {
    for (int k = 0; k <= kTurn; ++k)
      for (const FormulaFunction& f : this->phi().formulas)
        if (f.reads(k) && !stays(k, this->p(), this->s(), plane)) return false;
    return this->laws_stay_in_plane(plane);
  }
};

// The coordinates that a formula of several pairs reads of each.
constexpr int kEach = 4;  // x, y, z, rz

/// phi = formula of coordinates of n pairs and the time.
template <int n>
struct CoupledRow : PhiHooks {
  FormulaFunction formula;
  static constexpr PhiSpec spec{.pairs = n, .counts_turns = true};

  template <class T, class... More>
  T operator()(const LockCoords<T>& first, const More&... more) const {
    std::array<T, std::size_t(kEach * n + 1)> v;
    std::size_t k = 0;
    const auto add = [&](const LockCoords<T>& y) {
      for (const T& x : {y.x, y.y, y.z, y.angle_z()}) v[k++] = x;
    };
    add(first), (add(more), ...);
    v[k] = first.t;
    return formula(std::span<const T>(v));
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    formula.breakpoints(kEach * n, t0, t1, out);
  }
};

template <int n>
class FormulaCoupling final : public PhiCoupling<CoupledRow<n>> {
 public:
  using PhiCoupling<CoupledRow<n>>::PhiCoupling;
  std::string_view type() const override { return "function"; }
  bool stays_in_plane(Plane plane) const override {
    const std::vector<MarkerPair> pairs = this->pairs();
    for (int k = 0; k < kEach * n; ++k) {
      const auto& [p, s] = pairs[static_cast<std::size_t>(k / kEach)];
      const bool still = MarkerFrame(*p).stays_in_plane(plane) && MarkerFrame(*s).stays_in_plane(plane);
      if (this->phi().formula.reads(k) && !(still && stays(k % kEach < 3 ? k % kEach : kTurn, *p, *s, plane)))
        return false;
    }
    return true;
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

FormulaFunction read_formula(const Value& v, const std::string& place, const std::vector<NamedNumbers>& constants) {
  FormulaFunction f;
  try {
    expression::Scope scope;
    for (std::size_t k = 0; k < kVariables.size(); ++k) {
      const int i = static_cast<int>(k);  // the quaternion is of pure numbers
      const Unit unit = i < kTime ? Unit::length : i == kTime ? Unit::time : i == kTurn ? Unit::angle : Unit::none;
      scope.add(kVariables[k], i, dimension_of(unit));
    }
    scope.add(constants);
    const expression::Expression e(read_text(v, place), kVariables);
    f = scope.compiled(e, e.root());
    scope.check(e, std::nullopt);
  } catch (const ModelError& error) {
    refuse(v.where, place, error.what());
  }
  if (!read_any({&f, 1}, 0, kTime) && !read_any({&f, 1}, kRotation, kTurn + 1))
    refuse(v.where, place, "it uses no coordinate, so it constrains nothing; known: x, y, z, e0, e1, e2, e3, rz");
  return f;
}

// The coordinates of the pairs by the names of their joints.
template <int n>
std::unique_ptr<Lock> coupling_of(const Attachment& a, const Value& phi, const std::string& place,
                                  const std::vector<NamedNumbers>& constants) {
  const auto variable = [&](const std::string& name) {
    const std::shared_ptr<Coordinate> c = a.coordinate ? a.coordinate(name) : nullptr;
    for (std::size_t k = 0; c != nullptr && k < a.pairs.size(); ++k) {
      const bool of_pair = c->from().marker == a.pairs[k].first && c->to().marker == a.pairs[k].second;
      const Coordinate::Of of = c->of();
      const bool turn = of.kind == Coordinate::Kind::turn && of.axis == 2;
      if (!of_pair || of.order > 0 || !(turn || of.kind == Coordinate::Kind::position)) continue;
      const int at = kEach * static_cast<int>(k) + (turn ? 3 : of.axis);
      return expression::Scope::Name{{.variable = at}, c->dimension()};
    }
    throw ModelError("\"" + name +
                     "\" is no parameter, table or coordinate of one of its \"pairs\"; it can read x, y, " +
                     "z and rz of their joints (crank.rz), and t");
  };
  CoupledRow<n> row;
  try {
    expression::Scope scope(variable);
    scope.add("t", kEach * n, dimension_of(Unit::time));
    scope.add(constants);
    const expression::Expression e(read_text(phi, place), std::vector<std::string>{"t"}, expression::Naming::channels);
    row.formula = scope.compiled(e, e.root());
    scope.check(e, std::nullopt);
  } catch (const SceneError&) {
    throw;
  } catch (const ModelError& error) {
    refuse(phi.where, place, error.what());
  }
  if (!read_any({&row.formula, 1}, 0, kEach * n))
    refuse(phi.where, place, "it uses no coordinate, so it constrains nothing");
  return std::make_unique<FormulaCoupling<n>>(CoupledPairs(a), std::move(row));
}

}  // namespace

TypeInfo FormulaJoint::info() {
  return {
      "function",
      "formulas of the pose of P relative to S, or of the coordinates of two or three \"pairs\", each held at zero; "
      "degrees of freedom left: 6 less the formulas and mask",
      {{"phi", Form::any, Unit::none, kRequired,
        "formula, or list of up to 3: of x, y, z (m), e0 ... e3 (quaternion), rz (rad, counted) and t; with \"pairs\" "
        "one "
        "formula of x, y, z and rz of their joints: \"=lift.z - 0.1*sin(crank.rz)\""},
       {"mask", Form::text, Unit::none, "", "further constraints, as of a lock: words of x y z e1 e2 e3"},
       expression::constants_key()}};
}

std::unique_ptr<Lock> FormulaJoint::make(const Attachment& attachment, const Params& p) {
  const std::vector<NamedNumbers> constants = expression::read_constants(p, "parameters");
  const Value& phi = p.value("phi");
  const std::string place = part_of(p.owner(), "phi");
  if (attachment.pairs.size() > 1) {
    if (!p.text("mask").empty()) p.refuse("mask", "a coupling of pairs has none; remove it");
    return attachment.pairs.size() == 2 ? coupling_of<2>(attachment, phi, place, constants)
                                        : coupling_of<3>(attachment, phi, place, constants);
  }
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
