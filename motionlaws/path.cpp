// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include "motionlaws/built_in.h"
#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

SplineEndRates rates_of(const PathEndValues& e) {
  return {e.start_velocity, e.end_velocity, e.start_acceleration, e.end_acceleration};
}

SplineCurve curve_of(const PathPoints& points, const SplineSettings& k, const PathEndValues& ends) {
  std::vector<double> t;
  MatX y(static_cast<Eigen::Index>(points.size()), 3);
  for (const auto& [time, x] : points) {
    y.row(static_cast<Eigen::Index>(t.size())) = x.transpose();
    t.push_back(time);
  }
  return SplineCurve("path", std::move(t), y, k, rates_of(ends));
}

class PathLaw final : public TranslationLaw {
 public:
  explicit PathLaw(SplineCurve curve) : curve_(std::move(curve)) {}
  TranslationValue at(double t) const override {
    TranslationValue r;
    as_built_in_law("path", [&] { curve_.at(t, r.x.data(), r.v.data(), r.a.data()); });
    return r;
  }
  bool stays_in_plane(const Vec3& normal) const override { return curve_.is_constant(normal); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { curve_.breakpoints(t0, t1, out); }

 private:
  SplineCurve curve_;
};

}  // namespace

namespace laws {
LawPtr<TranslationLaw> path(const PathPoints& points, const SplineSettings& k, const PathEndValues& ends) {
  return std::make_shared<const PathLaw>(curve_of(points, k, ends));
}
}  // namespace laws

void add_path(LawTypes& types) {
  TypeInfo i{"path",
             "spline through points [t, x, y, z] or four columns of a CSV file, in axes of the frame",
             {{"points",
               Form::points,
               Unit::any,
               kOptional,
               "[[t, x, y, z], ...], times increasing; this or file",
               {},
               LawQuantity::value},
              {"file", Form::text, Unit::none, kOptional,
               "CSV file, in SI or with units in its header; path from the scene's folder"},
              {"t_column", Form::text, Unit::none, "t", "name or number of the column of times"},
              {"x_column", Form::text, Unit::none, "x", "name or number of the column of x"},
              {"y_column", Form::text, Unit::none, "y", "name or number of the column of y"},
              {"z_column", Form::text, Unit::none, "z", "name or number of the column of z"}}};
  add_spline_keys(i.keys);
  for (const char* key : {"start_velocity", "end_velocity"})
    i.keys.push_back({key, Form::vector3, Unit::speed, Value::List{0, 0, 0}, "velocity at a clamped end"});
  for (const char* key : {"start_acceleration", "end_acceleration"})
    i.keys.push_back(
        {key, Form::vector3, Unit::acceleration, Value::List{0, 0, 0}, "acceleration at a clamped end of degree 5"});
  types.translation_laws.add(std::move(i), [](const Params& p) {
    const SplineSettings k = spline_settings(p);
    check_end_keys(p, k, {"start_velocity", "end_velocity"}, {"start_acceleration", "end_acceleration"});
    Columns table = points_of(p, 3, p.text("t_column"), {p.text("x_column"), p.text("y_column"), p.text("z_column")});
    const PathEndValues ends{p.vector3("start_velocity"), p.vector3("end_velocity"), p.vector3("start_acceleration"),
                             p.vector3("end_acceleration")};
    return std::make_shared<const PathLaw>(SplineCurve("path", std::move(table.t), table.y, k, rates_of(ends)));
  });
}

}  // namespace lockstep
