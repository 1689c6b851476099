// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include <cmath>

#include <lockstep/function_laws.h>
#include "framework/mechanism/params/read.h"
#include "motionlaws/built_in.h"
#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

constexpr const char* kLaw = "spline_rotation";

std::string ordinal(Eigen::Index i) { return text::number(static_cast<double>(i + 1)); }

// One row per quaternion, of length 1, with the sign that is nearest to its neighbour.
MatX aligned(const RotationPoints& points) {
  MatX q(static_cast<Eigen::Index>(points.size()), 4);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    q.row(i) = require_orientation(kLaw, "points", points[i].second).coefficients().transpose();
    if (i == 0) continue;
    const double cosine = q.row(i).dot(q.row(i - 1));
    require(std::abs(cosine) > 1e-6, kLaw, "points",
            "number " + ordinal(i - 1) + " and " + ordinal(i) +
                " are 180 deg apart, so the direction of rotation is undefined; give an orientation between them");
    if (cosine < 0) q.row(i) *= -1.0;
  }
  return q;
}

SplineCurve curve_of(const RotationPoints& points, const SplineSettings& k) {
  Columns all{{}, aligned(points)};
  for (const auto& [time, orientation] : points) all.t.push_back(time);
  MatX& q = all.y;
  double turn = 1;  // -1: back at the first orientation after an odd number of full turns
  if (k.ends == SplineEnds::periodic && q.rows() > 0) {
    turn = q.bottomRows(1).row(0).dot(q.row(0)) < 0 ? -1.0 : 1.0;
    const double gap = (q.bottomRows(1) - turn * q.topRows(1)).norm();
    require(gap < 1e-9, kLaw, "points",
            "end " + text::number(2.0 * gap) +
                " rad away from the first; with periodic ends the last must equal the first");
    q.bottomRows(1) = turn * q.topRows(1);
  }
  return SplineCurve(kLaw, all, k, MatX::Zero(4, 4), turn);
}

class SplineRotation final : public RotationLaw {
 public:
  SplineRotation(const RotationPoints& points, const SplineSettings& k) : curve_(curve_of(points, k)) {
    constexpr int kSamples = 32;
    for (std::size_t i = 1; i < points.size(); ++i)
      for (int j = 1; j < kSamples; ++j) {
        Vec4 r, rd, rdd;
        const double t0 = points[i - 1].first, t1 = points[i].first;
        curve_.at(t0 + (t1 - t0) * j / kSamples, r.data(), rd.data(), rdd.data());
        require(r.norm() > 0.5, kLaw, "points",
                "rotate too far between " + text::number(t0) + " s and " + text::number(t1) +
                    " s; give orientations between them");
      }
  }
  RotationValue at(double t) const override {
    Vec4 r, rd, rdd;
    as_built_in_law(kLaw, [&] { curve_.at(t, r.data(), rd.data(), rdd.data()); });
    const auto jet = [&](int k) { return Time(r[k], rd[k], rdd[k]); };
    return rotation_value({jet(0), jet(1), jet(2), jet(3)});
  }
  // The components of its quaternion across the axis are constant, and zero at the start.
  bool turns_about(const Vec3& axis) const override {
    const Vec3 q = at(curve_.first()).q.vec();
    for (int k = 0; k < 3; ++k) {
      const Vec3 across = Vec3::Unit(k) - axis[k] * axis;
      VecX weights = VecX::Zero(4);
      weights.tail<3>() = across;
      if (!are_perpendicular(across, q) || !curve_.is_constant(weights)) return false;
    }
    return true;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { curve_.breakpoints(t0, t1, out); }

 private:
  SplineCurve curve_;
};

}  // namespace

LawPtr<RotationLaw> laws::spline_rotation(const RotationPoints& points, const SplineSettings& k) {
  return std::make_shared<const SplineRotation>(points, k);
}

void add_spline_rotation(LawTypes& types) {
  TypeInfo i{kLaw,
             "spline through orientations",
             {{"points", Form::any, Unit::none, kRequired,
               "list of [t, orientation]: times increasing, orientations in any form"}}};
  add_spline_keys(i.keys);
  types.rotation_laws.add(std::move(i), [](const Params& p) {
    const Value& list = p.value("points");
    if (list.list() == nullptr) p.refuse("points", "must be a list [[t, orientation], ...], not " + shown(list));
    RotationPoints points;
    for (const Value& point : *list.list()) {
      const std::string place = p.owner() + ".points[" + std::to_string(points.size()) + "]";
      if (point.list() == nullptr || point.list()->size() != 2)
        refuse(point.where, place, "must be [t, orientation], not " + shown(point));
      const double t = read_number((*point.list())[0], Unit::time, place);
      points.emplace_back(t, read_orientation_told((*point.list())[1], place));
    }
    return laws::spline_rotation(points, spline_settings(p));
  });
}

}  // namespace lockstep
