// The keys that 'spline', 'path' and 'spline_rotation' share, and how they are read.
#pragma once

#include <string>
#include <vector>

#include "framework/model/params.h"
#include "motionlaws/spline_curve.h"
#include "motionlaws/columns.h"

namespace lockstep {

/// Appends degree, ends and outside.
void add_spline_keys(Keys&);
SplineSettings spline_settings(const Params&);

/// The points of a law with the keys "points" (rows [t, y...]) or "file" with `t_column` and `y_columns`: exactly one of both.
Columns points_of(const Params&, std::size_t n_components, const std::string& t_column, const std::vector<std::string>& y_columns);

}  // namespace lockstep
