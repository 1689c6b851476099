// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/splines.h>

#include <lockstep/laws.h>

#include "motionlaws/built_in.h"

namespace lockstep {
namespace {

SplineEndRates rates_of(const PathEndValues& e) {
  return {e.start_velocity, e.end_velocity, e.start_acceleration, e.end_acceleration};
}

SplineCurve curve_of(const PathLaw::Points& points, const SplineSettings& k, const PathEndValues& ends) {
  std::vector<double> t;
  MatX y(static_cast<Eigen::Index>(points.size()), 3);
  for (const auto& [time, x] : points) {
    y.row(static_cast<Eigen::Index>(t.size())) = x.transpose();
    t.push_back(time);
  }
  return SplineCurve("path", std::move(t), y, k, rates_of(ends));
}

}  // namespace

PathLaw::PathLaw(const Points& points, const SplineSettings& k, const PathEndValues& ends)
    : curve_(curve_of(points, k, ends)) {}

TranslationValue PathLaw::at(double t) const {
  TranslationValue r;
  as_built_in_law("path", [&] { curve_.at(t, r.x.data(), r.v.data(), r.a.data()); });
  return r;
}

bool PathLaw::stays_in_plane(const Vec3& normal) const { return curve_.is_constant(normal); }

void PathLaw::breakpoints(double t0, double t1, std::vector<double>& out) const { curve_.breakpoints(t0, t1, out); }

const TypeInfo& PathLaw::info() {
  static const TypeInfo info = [] {
    TypeInfo i{"path",
               "smooth through points [t, x, y, z] or four columns of a CSV file, in axes of the frame",
               {{"points",
                 Form::points,
                 Unit::any,
                 kOptional,
                 "[[t, x, y, z], ...], times rising; this or file",
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
    return i;
  }();
  return info;
}

LawPtr<TranslationLaw> PathLaw::make(const Params& p) {
  const SplineSettings k = spline_settings(p);
  check_end_keys(p, k, {"start_velocity", "end_velocity"}, {"start_acceleration", "end_acceleration"});
  Columns table = points_of(p, 3, p.text("t_column"), {p.text("x_column"), p.text("y_column"), p.text("z_column")});
  const PathEndValues ends{p.vector3("start_velocity"), p.vector3("end_velocity"), p.vector3("start_acceleration"),
                           p.vector3("end_acceleration")};
  return std::make_shared<const PathLaw>(SplineCurve("path", std::move(table.t), table.y, k, rates_of(ends)));
}

namespace laws {
LawPtr<TranslationLaw> path(const PathLaw::Points& points, const SplineSettings& k, const PathEndValues& ends) {
  return std::make_shared<const PathLaw>(points, k, ends);
}
}  // namespace laws

}  // namespace lockstep
