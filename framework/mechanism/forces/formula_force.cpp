// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/forces/formula_force.h"

#include <algorithm>
#include <array>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/scope.h"
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

CoordinateForce::CoordinateForce(std::string name, Marker& p, Marker& s, Coordinate::Of q,
                                 expression::FormulaFunction f, Readings reads)
    : FormulaForce(std::move(name), p, &s),
      q_(q, {p.body, &p}, {s.body, &s}),
      f_(std::move(f)),
      reads_(std::move(reads)) {}

TypeInfo CoordinateForce::info() {
  return {
      "function_force",
      "force or torque by a formula of a coordinate q of P relative to S, its rate qd, time t, and coordinates of "
      "others, such as crank.rz, crank.rz_d and P.x",
      {{"force", Form::text, Unit::none, kOptional,
        "force on P along an axis of S, or away from S, N: \"=-800*q - 20*qd + 5*sin(t)\", q in m, all numbers in SI "
        "or all with units"},
       {"torque", Form::text, Unit::none, kOptional,
        "or torque on P about an axis of S, N m; q in rad, revolutions counted"},
       {"coordinate",
        Form::choice,
        Unit::none,
        kOptional,
        "coordinate q of P relative to S; default: z for a force, rz for a torque",
        {"x", "y", "z", "distance", "rx", "ry", "rz"}},
       expression::constants_key()}};
}

std::unique_ptr<Force> CoordinateForce::make(const Attachment& attachment, const Params& k) {
  if (k.has("force") == k.has("torque"))
    k.refuse(k.has("force") ? "torque" : "",
             k.has("force") ? "\"force\" is given as well; remove one of the two" : "give \"force\" or \"torque\"");
  const bool torque = k.has("torque");
  const char* key = torque ? "torque" : "force";
  const std::string word = k.has("coordinate") ? k.text("coordinate") : torque ? "rz" : "z";
  const bool turns = word.starts_with('r');
  if (turns != torque)
    k.refuse("coordinate", torque ? "a torque is about rx, ry or rz" : "a force is along x, y, z or distance");
  const Coordinate::Of q{turns                ? Coordinate::Kind::turn
                         : word == "distance" ? Coordinate::Kind::distance
                                              : Coordinate::Kind::position,
                         word == "distance" ? 0 : word.back() - 'x'};
  Readings reads;
  try {
    const std::vector<std::string> own = {"q", "qd", "t"};
    expression::Scope scope([&](const std::string& name) {
      if (!attachment.coordinate || name.find('.') == std::string::npos)
        throw ModelError("unknown name \"" + name + "\"" + text::suggestion(name, scope.names()));
      reads.push_back(attachment.coordinate(name));
      if (own.size() + reads.size() > kMostVariables)
        throw ModelError("the formula reads more than " + std::to_string(kMostVariables) + " numbers; split the force");
      return expression::Meaning::of_variable(static_cast<int>(own.size() + reads.size()) - 1,
                                              reads.back()->dimension(), false, true);
    });
    scope.add("q", 0, dimension_of(torque ? Unit::angle : Unit::length));
    scope.add("qd", 1, dimension_of(torque ? Unit::angular_speed : Unit::speed));
    scope.add("t", 2, dimension_of(Unit::time));
    scope.add(expression::read_constants(k, "parameters"));
    const expression::Expression e(k.text(key), own, expression::Naming::channels);
    expression::FormulaFunction f = scope.compiled(e, e.root());
    scope.check(e, dimension_of(torque ? Unit::torque : Unit::force));
    return std::make_unique<CoordinateForce>(attachment.name, p_of(attachment, k), s_of(attachment, k), q, std::move(f),
                                             std::move(reads));
  } catch (const ModelError& error) {
    k.refuse(key, error.what());
  }
}

void CoordinateForce::setup() {
  if (is_torque()) require_turning(p(), "rotates");
  if (q_.of().kind != Coordinate::Kind::distance) require_turning(*s(), is_torque() ? "rotates" : "has a lever arm on");
  MarkerForce::setup();
  also_.clear();
  for (const auto& read : reads_) {
    read->setup();
    for (const int slot : {read->m().slot, read->n().slot})
      if (std::ranges::find(also_, slot) == also_.end()) also_.push_back(slot);
  }
}

bool CoordinateForce::stays_in_plane(Plane plane) const {
  if (q_.of().kind == Coordinate::Kind::distance) return markers_stay_in(plane);
  const auto axis = static_cast<Axis>((is_torque() ? 3 : 0) + q_.of().axis);
  const auto fits = [&](const MarkerFrame& frame) { return axis_stays_in_plane(axis, frame.A0.row(plane.n)); };
  return markers_stay_in(plane, false) && fits(S_) && (is_torque() ? fits(P_) : has_no_arms(plane));
}

void CoordinateForce::count_angles(AngleCounter& counter) {
  q_.count_angles(counter);
  for (const auto& read : reads_) read->count_angles(counter);
}

void CoordinateForce::breakpoints(double t0, double t1, std::vector<double>& out) const {
  MarkerForce::breakpoints(t0, t1, out);
  f_.breakpoints(2, t0, t1, out);
}

std::vector<Quantity> CoordinateForce::quantities() const {
  const bool turn = is_torque();
  return {{"coordinate", turn ? "rad" : "m", "coordinate q of P relative to S"},
          {"rate", turn ? "rad/s" : "m/s", "its rate qd"},
          {turn ? "torque" : "force", turn ? "N m" : "N", "value of the formula, on P's body"},
          power()};
}

namespace {

// With its rate in time, by which a formula decides where what it compares is equal: t > 0.25 holds at 0.25 s.
Time with_rate(double x, double rate) { return {x, rate, 0.0}; }
double without_rate(const Time& x) { return x.v; }
template <int N>
Jet<N> with_rate(const Jet<N, double, NoMotion>& x, double rate) {
  Jet<N> y(x.v);
  y.d = rate, y.g = x.g;
  return y;
}
template <int N>
Jet<N, double, NoMotion> without_rate(const Jet<N>& x) {
  Jet<N, double, NoMotion> y(x.v);
  y.g = x.g;
  return y;
}

}  // namespace

// f(q, qd, t, ...), of `most` variables at most
template <std::size_t most, class T>
T CoordinateForce::effort(const Ends<T>& at, const T& q, const T& rate) const {
  std::array<T, most> v{q, rate, T(at.t)};
  std::array<double, most> rates{value_of(rate), 0, 1};
  std::size_t n = 3;
  for (const auto& read : reads_) {
    const MotionT<T> O_m = at.motion(read->m().slot), O_n = at.motion(read->n().slot);
    const MarkerOn<T> m{O_m, read->m().at(at.t)}, on{O_n, read->n().at(at.t)};
    if (f_.has_switches() && read->of().order == 0) rates[n] = value_of(read->rate(m, on, read->direction(m, on)));
    v[n++] = read->value(m, on, at.s);
  }
  if (!f_.has_switches()) return f_(std::span<const T>(v.data(), n));
  std::array<decltype(with_rate(v[0], 0)), most> moving;
  for (std::size_t k = 0; k < n; ++k) moving[k] = with_rate(v[k], rates[k]);
  return without_rate(f_(std::span<const decltype(with_rate(v[0], 0))>(moving.data(), n)));
}

template <class T, class Load>
void CoordinateForce::act(const Ends<T>& at, Load& load) const {
  const Vec3T<T> g = q_.direction(at.P, at.S);
  const bool has_value = value_of(g[0]) != 0 || value_of(g[1]) != 0 || value_of(g[2]) != 0;
  const T q = q_.value(at.P, at.S, at.s), rate = q_.rate(at.P, at.S, g);
  const T f = !has_value ? T(0) : reads_.empty() ? effort<3>(at, q, rate) : effort<kMostVariables>(at, q, rate);
  if (is_torque())
    load.torque(Vec3T<T>(f * g));
  else
    load.force(Vec3T<T>(f * g), at.P.x());
  load.supplies(f * rate);
  load.shows(q, rate, f);
}

template class FormulaForce<CoordinateForce>;

}  // namespace lockstep
