// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include "motionlaws/built_in.h"
#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class PathLaw final : public TranslationLaw {
 public:
  PathLaw(const Columns& points, const SplineSettings& k, const PathEndValues& ends)
      : curve_("path", points, k, rates_of(ends)) {}
  TranslationValue at(double t) const override {
    TranslationValue r;
    as_built_in_law("path", [&] { curve_.at(t, r.x.data(), r.v.data(), r.a.data()); });
    return r;
  }
  bool stays_in_plane(const Vec3& normal) const override { return curve_.is_constant(normal); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { curve_.breakpoints(t0, t1, out); }

 private:
  static MatX rates_of(const PathEndValues& e) {
    MatX rates(3, 4);
    rates << e.start_velocity, e.start_acceleration, e.end_velocity, e.end_acceleration;
    return rates.transpose();
  }

  SplineCurve curve_;
};

}  // namespace

LawPtr<TranslationLaw> laws::path(const PathPoints& points, const SplineSettings& k, const PathEndValues& ends) {
  std::vector<std::vector<double>> rows;
  for (const auto& [t, x] : points) rows.push_back({t, x[0], x[1], x[2]});
  return std::make_shared<const PathLaw>(columns_of(rows, 3), k, ends);
}

void add_path(LawTypes& types) {
  TypeInfo i{"path", "spline through points [t, x, y, z] or four columns of a CSV file, in axes of the frame",
             spline_keys("[[t, x, y, z], ...], times increasing; this or file", {{"x", "x"}, {"y", "y"}, {"z", "z"}})};
  for (const char* key : {"start_velocity", "end_velocity"})
    i.keys.push_back({key, Form::vector3, Unit::speed, Value::List{0, 0, 0}, "velocity at a clamped end"});
  for (const char* key : {"start_acceleration", "end_acceleration"})
    i.keys.push_back(
        {key, Form::vector3, Unit::acceleration, Value::List{0, 0, 0}, "acceleration at a clamped end, degree 5"});
  types.translation_laws.add(std::move(i), [](const Params& p) {
    const SplineSettings k = spline_settings(p);
    check_end_keys(p, k, {"start_velocity", "end_velocity"}, {"start_acceleration", "end_acceleration"});
    const PathEndValues ends{p.vector3("start_velocity"), p.vector3("end_velocity"), p.vector3("start_acceleration"),
                             p.vector3("end_acceleration")};
    return std::make_shared<const PathLaw>(
        points_of(p, 3, p.text("t_column"), {p.text("x_column"), p.text("y_column"), p.text("z_column")}), k, ends);
  });
}

}  // namespace lockstep
