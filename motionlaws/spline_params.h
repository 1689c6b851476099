// The keys that 'spline', 'path' and 'spline_rotation' share, and how they are read.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "framework/mechanism/params/params.h"
#include "motionlaws/columns.h"
#include "motionlaws/spline_curve.h"

namespace lockstep {

/// Appends degree, ends and outside.
void add_spline_keys(Keys&);
SplineSettings spline_settings(const Params&);

/// Refuses keys of end rates that would have no effect: without clamped ends, second derivatives without degree 5.
void check_end_keys(const Params&, const SplineSettings&, std::initializer_list<const char*> first,
                    std::initializer_list<const char*> second);

/// The points of a law with the keys "points" (rows [t, y...]) or "file" with `t_column` and `y_columns`: exactly one
/// of both.
Columns points_of(const Params&, std::size_t n_components, const std::string& t_column,
                  const std::vector<std::string>& y_columns);

}  // namespace lockstep
