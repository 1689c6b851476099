// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/joints.h>

#include <lockstep/author/params.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/checks.h"
#include "framework/mechanism/links/joint_functions.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {

SlideStop::SlideStop(std::string name, Marker& p, Marker& s, Options o)
    : FunctionLock(name, p, s, Mask::none,
                   rows_of(StopAlong{o.axis, checked(name, "limit", o.limit, true, "; it must be a finite number"),
                                     o.low ? 1.0 : -1.0})) {
  set_unilateral({});
}

TurnStop::TurnStop(std::string name, Marker& p, Marker& s, Options o)
    : FunctionLock(name, p, s, Mask::none,
                   rows_of(StopAbout{checked(name, "limit", o.limit, true, "; it must be a finite number"),
                                     o.low ? 1.0 : -1.0})) {
  set_unilateral({});
}

TypeInfo Stop::info() {
  return {"stop",
          "one end of a travel: the coordinate of P relative to S does not pass its limit",
          {{"coordinate",
            Form::choice,
            Unit::none,
            kRequired,
            "the coordinate: along an axis of S, or the rotation about its z, revolutions counted",
            {"x", "y", "z", "rz"}},
           {"low", Form::number, Unit::any, kOptional, "the coordinate stays above this, m or rad; or \"high\""},
           {"high", Form::number, Unit::any, kOptional, "the coordinate stays below this, m or rad; or \"low\""}}};
}

std::unique_ptr<Lock> Stop::make(const Attachment& attachment, const Params& params) {
  if (params.has("low") == params.has("high"))
    params.refuse(params.has("low") ? "high" : "",
                  params.has("low") ? "\"low\" is given as well; a stop has one limit, add another stop for the other"
                                    : "no limit is given; add \"low\" or \"high\"");
  const bool low = params.has("low");
  const Axis axis = axis_from(params.text("coordinate"));
  const char* key = low ? "low" : "high";
  const double limit =
      read_number(params.value(key), is_rotation(axis) ? Unit::angle : Unit::length, part_of(params.owner(), key));
  if (axis == Axis::rz)
    return std::make_unique<TurnStop>(attachment.name, attachment.p(), attachment.s(),
                                      TurnStop::Options{.limit = limit, .low = low});
  return std::make_unique<SlideStop>(attachment.name, attachment.p(), attachment.s(),
                                     SlideStop::Options{.axis = axis_index(axis), .limit = limit, .low = low});
}

}  // namespace lockstep
