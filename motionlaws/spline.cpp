// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include "motionlaws/built_in.h"
#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

SplineEndRates rates_of(const SplineEndValues& e) {
  const auto one = [](double x) { return VecX::Constant(1, x).eval(); };
  return {one(e.start_rate), one(e.end_rate), one(e.start_acceleration), one(e.end_acceleration)};
}

SplineCurve curve_of(const SplinePoints& points, const SplineSettings& k, const SplineEndValues& ends) {
  std::vector<double> t;
  MatX y(static_cast<Eigen::Index>(points.size()), 1);
  for (const auto& [time, value] : points) {
    y(static_cast<Eigen::Index>(t.size()), 0) = value;
    t.push_back(time);
  }
  return SplineCurve("spline", std::move(t), y, k, rates_of(ends));
}

class Spline final : public MotionLaw {
 public:
  explicit Spline(SplineCurve curve) : curve_(std::move(curve)) {}
  LawValue at(double t) const override {
    LawValue r;
    as_built_in_law("spline", [&] { curve_.at(t, &r.y, &r.yd, &r.ydd); });
    return r;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { curve_.breakpoints(t0, t1, out); }

 private:
  SplineCurve curve_;
};

}  // namespace

namespace laws {
LawPtr<MotionLaw> spline(const SplinePoints& points, const SplineSettings& k, const SplineEndValues& ends) {
  return std::make_shared<const Spline>(curve_of(points, k, ends));
}
}  // namespace laws

void add_spline(LawTypes& types) {
  TypeInfo i{"spline",
             "spline through points [t, y] or two columns of a CSV file",
             {{"points",
               Form::points,
               Unit::any,
               kOptional,
               "[[t, y], ...], times increasing; this or file",
               {},
               LawQuantity::value},
              {"file", Form::text, Unit::none, kOptional,
               "CSV file, in SI or with units in its header; path from the scene's folder"},
              {"t_column", Form::text, Unit::none, "t", "name or number of the column of times"},
              {"y_column", Form::text, Unit::none, "y", "name or number of the column of values"}}};
  add_spline_keys(i.keys);
  for (const char* key : {"start_rate", "end_rate"})
    i.keys.push_back({key, Form::number, Unit::any, 0, "yd at a clamped end", {}, LawQuantity::rate});
  for (const char* key : {"start_acceleration", "end_acceleration"})
    i.keys.push_back(
        {key, Form::number, Unit::any, 0, "ydd at a clamped end of degree 5", {}, LawQuantity::acceleration});
  types.laws.add(std::move(i), [](const Params& p) {
    const SplineSettings k = spline_settings(p);
    check_end_keys(p, k, {"start_rate", "end_rate"}, {"start_acceleration", "end_acceleration"});
    Columns table = points_of(p, 1, p.text("t_column"), {p.text("y_column")});
    const SplineEndRates rates = rates_of(
        {p.number("start_rate"), p.number("end_rate"), p.number("start_acceleration"), p.number("end_acceleration")});
    return std::make_shared<const Spline>(SplineCurve("spline", std::move(table.t), table.y, k, rates));
  });
}

}  // namespace lockstep
