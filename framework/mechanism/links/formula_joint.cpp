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

// The coordinates of a pair, by their numbers among the variables of a formula: kTurn counts turns, those from kQuaternion
// on read the rotation. A formula of several pairs reads those before of each. The time is the last variable.
const std::vector<std::string> kVariables = {"x", "y", "z", "rz", "e0", "e1", "e2", "e3", "t"};
constexpr int kTurn = 3, kQuaternion = 4, kAll = 8;
constexpr int of_each(int pairs) { return pairs > 1 ? kQuaternion : kAll; }
constexpr int time_of(int pairs) { return pairs * of_each(pairs); }

/// phi = n formulas of the relative coordinates of pairs and the time.
template <int pairs, int n, Reads reads, bool counts>
struct FormulaRows : PhiHooks {
  std::array<FormulaFunction, std::size_t(n)> formulas;
  static constexpr PhiSpec spec{.pairs = pairs, .rows = n, .reads = reads, .counts_turns = counts};

  template <class T, class... More>
  auto operator()(const LockCoords<T>& first, const More&... more) const
      -> std::conditional_t<n == 1, T, std::array<T, std::size_t(n)>> {
    std::array<T, std::size_t(time_of(pairs) + 1)> v;
    T* of = v.data();
    const auto add = [&](const LockCoords<T>& y) {
      of[0] = y.x, of[1] = y.y, of[2] = y.z;
      if constexpr (counts) of[kTurn] = y.angle_z();
      if constexpr (pairs == 1 && reads == Reads::both) of[4] = y.e0, of[5] = y.e1, of[6] = y.e2, of[7] = y.e3;
      of += of_each(pairs);
    };
    add(first), (add(more), ...);
    v.back() = first.t;
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
    for (const FormulaFunction& f : formulas) f.breakpoints(time_of(pairs), t0, t1, out);
  }
};

// In a plane only translations along it and turns about its normal change; all other derivatives must be zero.
bool stays(int coordinate, const Marker& p, const Marker& s, Plane plane) {
  const MarkerFrame P(p), S(s);
  if (!P.stays_in_plane(plane) || !S.stays_in_plane(plane)) return false;
  const Vec3 normal = S.A0.row(plane.n);
  if (coordinate < kTurn) return axis_stays_in_plane(Axis(coordinate), normal);
  const int axis = coordinate == kTurn ? 3 : coordinate - kQuaternion;  // 0: none, the scalar part
  return (Vec3(P.A0.row(plane.n)) - normal).norm() <= kParallel &&
         (axis == 0 || axis_stays_in_plane(Axis(2 + axis), normal));
}

template <class Phi>
using JointOf = std::conditional_t<Phi::spec.pairs == 1, PhiLock<Phi>, PhiCoupling<Phi>>;

template <class Phi>
class FormulaLink final : public JointOf<Phi> {
 public:
  using JointOf<Phi>::JointOf;
  std::string_view type() const override { return "function"; }
  bool stays_in_plane(Plane plane) const override {
    constexpr int each = of_each(Phi::spec.pairs);
    const std::vector<MarkerPair> pairs = this->pairs();
    for (int k = 0; k < time_of(Phi::spec.pairs); ++k) {
      const auto& [p, s] = pairs[static_cast<std::size_t>(k / each)];
      for (const FormulaFunction& f : this->phi().formulas)
        if (f.reads(k) && !stays(k % each, *p, *s, plane)) return false;
    }
    if constexpr (Phi::spec.pairs == 1) return this->laws_stay_in_plane(plane);
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

template <int pairs, int n, Reads reads, bool counts>
std::unique_ptr<Lock> link_of(const Attachment& a, Mask mask, const std::vector<FormulaFunction>& formulas) {
  using Rows = FormulaRows<pairs, n, reads, counts>;
  Rows phi;
  std::copy_n(formulas.begin(), std::size_t(n), phi.formulas.begin());
  if constexpr (pairs == 1)
    return std::make_unique<FormulaLink<Rows>>(a.name, a.p(), a.s(), mask, std::move(phi));
  else
    return std::make_unique<FormulaLink<Rows>>(CoupledPairs(a), std::move(phi));
}

template <int n>
std::unique_ptr<Lock> link_of(const Attachment& a, Mask mask, const std::vector<FormulaFunction>& formulas) {
  if (read_any(formulas, kTurn, kTurn + 1)) return link_of<1, n, Reads::both, true>(a, mask, formulas);
  if (read_any(formulas, kQuaternion, kAll)) return link_of<1, n, Reads::both, false>(a, mask, formulas);
  return link_of<1, n, Reads::translation, false>(a, mask, formulas);
}

// A coordinate of one of the pairs by the name of its joint.
expression::Meaning coordinate_of(const Attachment& a, const std::string& name) {
  const std::shared_ptr<Coordinate> c = a.coordinate ? a.coordinate(name) : nullptr;
  for (std::size_t k = 0; c != nullptr && k < a.pairs.size(); ++k) {
    const bool of_pair = c->from().marker == a.pairs[k].first && c->to().marker == a.pairs[k].second;
    const Coordinate::Of of = c->of();
    const bool turn = of.kind == Coordinate::Kind::turn && of.axis == 2;
    if (!of_pair || of.order > 0 || !(turn || of.kind == Coordinate::Kind::position)) continue;
    return expression::Meaning::of_variable(of_each(2) * static_cast<int>(k) + (turn ? kTurn : of.axis), c->dimension(),
                                            false, true);
  }
  throw ModelError("\"" + name + "\" is no parameter, table or coordinate of one of its \"pairs\"; it can read x, y, " +
                   "z and rz of their joints (crank.rz), and t");
}

FormulaFunction read_formula(const Attachment& a, const Value& v, const std::string& place,
                             const std::vector<NamedNumbers>& constants) {
  using namespace expression;
  const bool coupled = a.pairs.size() > 1;
  const int time = time_of(coupled ? static_cast<int>(a.pairs.size()) : 1);
  const std::string text = read_text(v, place);
  return placed(v.where, place, [&] {
    Scope scope(coupled ? Scope::Others([&](const std::string& name) { return coordinate_of(a, name); }) : nullptr);
    for (int k = 0; k < kAll && !coupled; ++k)  // the quaternion is of pure numbers
      scope.add(kVariables[static_cast<std::size_t>(k)], k,
                dimension_of(k < kTurn    ? Unit::length
                             : k == kTurn ? Unit::angle
                                          : Unit::none));
    scope.add("t", time, dimension_of(Unit::time));
    scope.add(constants);
    const Expression e(text, coupled ? std::span(kVariables).last(1) : kVariables,
                       coupled ? Naming::channels : Naming::words);
    FormulaFunction f = scope.compiled(e, e.root());
    scope.check(e, std::nullopt);
    if (!read_any({&f, 1}, 0, time))
      throw ModelError(std::string("it uses no coordinate, so it constrains nothing") +
                       (coupled ? "" : "; known: x, y, z, e0, e1, e2, e3, rz"));
    return f;
  });
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
  const auto read = [&](const Value& v, const std::string& at) { return read_formula(attachment, v, at, constants); };
  if (attachment.pairs.size() > 1) {
    if (!p.text("mask").empty()) p.refuse("mask", "a coupling of pairs has none; remove it");
    const auto make =
        attachment.pairs.size() == 2 ? link_of<2, 1, Reads::both, true> : link_of<3, 1, Reads::both, true>;
    return make(attachment, Mask::none, {read(phi, place)});
  }
  std::vector<FormulaFunction> formulas;
  if (phi.list() == nullptr)
    formulas.push_back(read(phi, place));
  else
    for (std::size_t i = 0; i < phi.list()->size(); ++i) formulas.push_back(read((*phi.list())[i], item(place, i)));
  const std::string words = p.text("mask");
  const Mask mask = words.empty() ? Mask::none : mask_from(words);
  if (formulas.size() == 1) return link_of<1>(attachment, mask, formulas);
  if (formulas.size() == 2) return link_of<2>(attachment, mask, formulas);
  if (formulas.size() == 3) return link_of<3>(attachment, mask, formulas);
  p.refuse("phi",
           "it has " + std::to_string(formulas.size()) + " formulas; give 1, 2 or 3, and another joint for more");
}

}  // namespace lockstep
