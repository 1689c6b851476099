// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/couplings.h>

#include <lockstep/author/params.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/checks.h"
#include "framework/mechanism/links/gear_functions.h"

namespace lockstep {
namespace {

double positive(const CoupledPairs& pairs, const char* key, double x) {
  return checked(pairs.name, key, x, x > 0 && x < 1e300, "; it must be above zero");
}

Gear::Mesh mesh_of(const std::string& word) {
  return word == "internal" ? Gear::Mesh::internal : word == "bevel" ? Gear::Mesh::bevel : Gear::Mesh::external;
}

}  // namespace

Gear::Gear(const CoupledPairs& pairs, double ratio, Mesh mesh)
    : FunctionCoupling(
          pairs, rows_of(TurnsOfTwo({1.0, (mesh == Mesh::internal ? -1.0 : 1.0) * positive(pairs, "ratio", ratio)}))) {}

TypeInfo Gear::info() {
  return {"gear",
          "two gears in joints on a common carrier, each rotating about its own z",
          {{"ratio", Form::number, Unit::none, kOptional, "revolutions of gear 1 per one of gear 2; or give the teeth"},
           {"teeth_1", Form::integer, Unit::none, kOptional, "teeth of gear 1"},
           {"teeth_2", Form::integer, Unit::none, kOptional, "teeth of gear 2"},
           {"mesh",
            Form::choice,
            Unit::none,
            "external",
            "external and bevel rotate in opposite senses (bevel: both z away from the apex), internal in the same",
            {"external", "internal", "bevel"}}}};
}

std::unique_ptr<Lock> Gear::make(const Attachment& attachment, const Params& p) {
  const bool teeth = p.has("teeth_1") || p.has("teeth_2");
  if (teeth && p.has("ratio")) p.refuse("ratio", "the teeth are given as well; remove one of the two");
  if (!teeth && !p.has("ratio")) p.refuse("ratio", "is missing; give it, or \"teeth_1\" and \"teeth_2\"");
  if (teeth)
    for (const char* key : {"teeth_1", "teeth_2"}) {
      if (!p.has(key)) p.refuse(key, "is missing; a gear ratio needs the teeth of both");
      if (p.integer(key) < 1) p.refuse(key, "is " + std::to_string(p.integer(key)) + "; a gear has at least one");
    }
  const double ratio = teeth ? double(p.integer("teeth_2")) / p.integer("teeth_1") : p.number("ratio");
  return std::make_unique<Gear>(attachment, ratio, mesh_of(p.text("mesh")));
}

Belt::Belt(const CoupledPairs& pairs, Options o)
    : FunctionCoupling(pairs,
                       rows_of(TurnsOfTwo({positive(pairs, "radius_1", o.radius1),
                                           (o.crossed ? 1.0 : -1.0) * positive(pairs, "radius_2", o.radius2)}))) {}

TypeInfo Belt::info() {
  return {"belt",
          "two pulleys in joints on a common carrier, each rotating about its own z; no slip",
          {{"radius_1", Form::number, Unit::length, kRequired, "radius of pulley 1"},
           {"radius_2", Form::number, Unit::length, kRequired, "radius of pulley 2"},
           {"crossed", Form::boolean, Unit::none, false, "the pulleys rotate in opposite senses"}}};
}

std::unique_ptr<Lock> Belt::make(const Attachment& attachment, const Params& p) {
  return std::make_unique<Belt>(
      attachment,
      Options{.radius1 = p.number("radius_1"), .radius2 = p.number("radius_2"), .crossed = p.boolean("crossed")});
}

Differential::Differential(const CoupledPairs& pairs, double ratio)
    : FunctionCoupling(pairs, rows_of(TurnsOfThree({1.0, positive(pairs, "ratio", ratio), -(1.0 + ratio)}))) {}

TypeInfo Differential::info() {
  return {"differential",
          "three rotations on a common carrier: theta1 + ratio theta2 = (1 + ratio) theta3",
          {{"ratio", Form::number, Unit::none, 1, "1: wheel, wheel, cage; teeth of ring to sun: sun, ring, arm"}}};
}

std::unique_ptr<Lock> Differential::make(const Attachment& attachment, const Params& p) {
  return std::make_unique<Differential>(attachment, p.number("ratio"));
}

}  // namespace lockstep
