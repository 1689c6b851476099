// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include "motionlaws/built_in.h"
#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class Spline final : public MotionLaw {
 public:
  Spline(const Columns& points, const SplineSettings& k, const SplineEndValues& e)
      : curve_("spline", points, k, Vec4(e.start_rate, e.start_acceleration, e.end_rate, e.end_acceleration)) {}
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

LawPtr<MotionLaw> laws::spline(const SplinePoints& points, const SplineSettings& k, const SplineEndValues& ends) {
  std::vector<std::vector<double>> rows;
  for (const auto& [t, y] : points) rows.push_back({t, y});
  return std::make_shared<const Spline>(columns_of(rows, 1), k, ends);
}

void add_spline(LawTypes& types) {
  TypeInfo i{"spline", "spline through points [t, y] or two columns of a CSV file",
             spline_keys("[[t, y], ...], times increasing; this or file", {{"y", "values"}})};
  for (const char* key : {"start_rate", "end_rate"})
    i.keys.push_back(value_key(key, Form::number, 0, "rate of y at a clamped end", LawQuantity::rate));
  for (const char* key : {"start_acceleration", "end_acceleration"})
    i.keys.push_back(value_key(key, Form::number, 0, "second derivative of y at a clamped end, degree 5",
                               LawQuantity::acceleration));
  types.laws.add(std::move(i), [](const Params& p) {
    const SplineSettings k = spline_settings(p);
    check_end_keys(p, k, {"start_rate", "end_rate"}, {"start_acceleration", "end_acceleration"});
    const SplineEndValues ends{p.number("start_rate"), p.number("end_rate"), p.number("start_acceleration"),
                               p.number("end_acceleration")};
    return std::make_shared<const Spline>(points_of(p, 1, p.text("t_column"), {p.text("y_column")}), k, ends);
  });
}

}  // namespace lockstep
