// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/tables.h"

#include <cassert>
#include <optional>
#include <utility>

#include <lockstep/dynamics.h>
#include <lockstep/forces.h>

namespace lockstep {
namespace {

/// A key with what it holds where its form is Form::any.
struct Row {
  Key key;
  std::optional<Part> part{};
};
using Rows = std::vector<Row>;
using Text = std::string;
using Words = std::vector<Text>;

Row any_key(const Text& name, Holds holds, const Text& table, const Text& help, const Words& choices = {}) {
  return {{name, Form::any, Unit::none, kOptional, help, choices}, Part{name, holds, table}};
}
Row choice_key(const Text& name, const Default& fallback, const Words& choices, const Text& help) {
  return {{name, Form::choice, Unit::none, fallback, help, choices}};
}
Row key_of(Form form, const Text& name, Unit unit, const Default& d, const Text& help) {
  return {{name, form, unit, d, help}};
}
Row text_key(const Text& name, const Default& d, const Text& help) {
  return key_of(Form::text, name, Unit::none, d, help);
}
Row flag_key(const Text& name, bool d, const Text& help) { return key_of(Form::boolean, name, Unit::none, d, help); }
Row integer_key(const Text& name, const Default& d, const Text& help) {
  return key_of(Form::integer, name, Unit::none, d, help);
}
Row axes_key(const Text& name, const Default& d, const Text& help) {
  return key_of(Form::orientation, name, Unit::none, d, help);
}
Row number_key(const Text& name, Unit u, const Default& d, const Text& help) {
  return key_of(Form::number, name, u, d, help);
}
Row vector_key(const Text& name, Unit u, const Default& d, const Text& help) {
  return key_of(Form::vector3, name, u, d, help);
}
Row law_key(const Text& name, Form form, Unit u, const Text& help) { return key_of(form, name, u, kOptional, help); }
Default zero() { return Value::List{0, 0, 0}; }
Default unturned() { return Value::List{1, 0, 0, 0}; }

Rows joined(const std::vector<Rows>& groups) {
  Rows all;
  for (const Rows& rows : groups) all.insert(all.end(), rows.begin(), rows.end());
  return all;
}

SceneTable table(const Text& name, const Text& help, const Rows& rows, const Text& shelf = "") {
  SceneTable t{{name, help, {}}, {}, shelf};
  for (const Row& row : rows) {
    t.info.keys.push_back(row.key);
    if (row.part) t.parts.push_back(*row.part);
  }
  return t;
}

SceneTable scene() {
  return table(
      "scene", "a mechanism, how it starts, how it runs and what is recorded",
      {
          integer_key("lockstep", kRequired, "version of this format: 1"),
          text_key("$schema", kOptional, "the JSON schema, for editors"),
          text_key("title", kOptional, "one line that says what moves"),
          text_key("description", kOptional, "more about it"),
          any_key(
              "parameters", Holds::quantities, "",
              "numbers and quantities by name: {\"crank\": \"100 mm\", \"ratio\": 2.5}; \"=crank*cos(30 deg)\" stands "
              "wherever a number does, here too"),
          any_key("points", Holds::named_points, "",
                  "points by name, world: {\"A\": [0, 0, 0], \"B\": \"=A + [crank, 0, 0]\"}; \"at\", \"from\", \"to\", "
                  "\"position\" of bodies, markers and links take a name"),
          any_key("requires", Holds::texts, "", "plugins that must be loaded, by bare name; no path"),
          vector_key("gravity", Unit::acceleration, zero(), "gravity, world axes"),
          choice_key(
              "planar", "auto", {"off", "auto", "x", "y", "z"},
              "normal of the plane of all motion: three velocities per body; \"auto\": where that is exact and all "
              "links, laws and forces are known to stay in it (without the key, only where joint coordinates do not "
              "serve)"),
          choice_key(
              "merge", "off", {"off", "auto"},
              "\"auto\": bodies joined by a fixed link without a law move as one; links that are recorded, or that "
              "events name, stay"),
          any_key("include", Holds::objects, "include", "other scenes as parts of this one"),
          any_key("repeat", Holds::objects, "repeat", "parts of the scene several times, with an index"),
          any_key("set", Holds::settings, "",
                  "other values of what included and repeated parts bring, by path: {\"bodies.left_leg.rod.mass\": 2}"),
          any_key("bodies", Holds::objects, "body", "the bodies; \"ground\" always exists"),
          any_key("markers", Holds::objects, "marker", "frames on bodies that links and forces name"),
          any_key("links", Holds::objects, "link", "what holds the bodies together"),
          any_key("forces", Holds::objects, "force", "the forces applied to them"),
          any_key("events", Holds::objects, "event", "changes of the links in force during the run"),
          any_key("run", Holds::object, "run", "integrator, duration, output"),
      });
}

SceneTable include() {
  return table(
      "include", "another scene as a part of this one: its points, bodies, markers, links, forces and events",
      {
          text_key("scene", kRequired, "its file, from the folder of this scene"),
          text_key("prefix", "", "put before its names, as in \"left_\""),
          vector_key("at", Unit::length, zero(), "where its origin is put, world"),
          axes_key("orientation", unturned(), "how its axes are turned, in the world; gravity is this scene's"),
          any_key("parameters", Holds::quantities, "", "other values of its parameters; formulas are of this scene's"),
      });
}

SceneTable repeat() {
  return table(
      "repeat",
      "parts of a scene, several times; \"{i}\" and \"{i+1}\" in texts become whole numbers, i in formulas is one",
      {
          integer_key("times", kRequired, "how many times"),
          text_key("index", "i", "name of the index"),
          integer_key("from", 0, "its first value"),
          any_key("points", Holds::named_points, "", "added to those of the scene"),
          any_key("bodies", Holds::objects, "body", "likewise"),
          any_key("markers", Holds::objects, "marker", "likewise"),
          any_key("links", Holds::objects, "link", "likewise, behind those of the scene"),
          any_key("forces", Holds::objects, "force", "likewise"),
      });
}

// The keys that give mass, the same for a body and for a part of a compound.
Rows mass_keys() {
  return {
      number_key("mass", Unit::mass, kOptional, "mass, given with \"inertia\""),
      any_key("inertia", Holds::vector_or_object, "inertia",
              "[Jxx, Jyy, Jzz], {\"xx\":, ..., \"xy\":}, or three rows; products as matrix entries"),
      any_key("inertia_at", Holds::vector_or_word, "", "point about which the inertia is given, own frame", {"center"}),
      axes_key("inertia_axes", unturned(), "axes of the inertia, in its own frame"),
      vector_key("center", Unit::length, zero(), "mass centre, own frame"),
      any_key("rod", Holds::object, "rod", "a rod; it defines the frame: in its middle, x along it"),
      any_key("box", Holds::object, "box", "a box about its frame's origin"),
      any_key("cylinder", Holds::object, "cylinder", "a cylinder about its frame's origin, along z"),
      any_key("sphere", Holds::object, "sphere", "a sphere about its frame's origin"),
  };
}

SceneTable body() {
  const Rows more = {
      any_key("compound", Holds::objects, "part", "several parts, rigidly joined, each placed in the body's frame"),
      number_key("particle", Unit::mass, kOptional, "mass of a particle, which has no rotation"),
      flag_key("fixed", false, "it never moves and needs no mass"),
      vector_key("position", Unit::length, zero(), "origin of its frame at the start, world"),
      axes_key("orientation", unturned(), "its axes at the start, in the world"),
      vector_key("velocity", Unit::speed, zero(), "of the frame's origin at the start, world axes"),
      vector_key("omega_body", Unit::angular_speed, kOptional, "angular velocity at the start, body axes"),
      vector_key("omega_world", Unit::angular_speed, kOptional, "angular velocity at the start, world axes"),
      choice_key("assembled", "approximate", {"approximate", "exact", "free"},
                 "what assembling the start may do to its pose: as little as the rest allows, nothing, or anything"),
      number_key("start_weight", Unit::none, 1, "how much its start pose counts against those of others"),
      any_key("visual", Holds::object, "visual", "what it looks like in reports"),
  };
  return table("body", "a rigid body, a particle or a fixed frame",
               joined({{text_key("name", kRequired, "its name, unique in the scene")}, mass_keys(), more}));
}

SceneTable part() {
  return table("part", "a part of a compound body",
               joined({mass_keys(),
                       {vector_key("position", Unit::length, zero(), "origin of the part's frame, body frame"),
                        axes_key("orientation", unturned(), "axes of the part, in the body frame")}}));
}

std::vector<SceneTable> shapes() {
  const Rows mass = {number_key("mass", Unit::mass, kOptional, "mass; or \"density\""),
                     number_key("density", Unit::density, kOptional, "mass by volume; or \"mass\"")};
  const Rows rod = {
      vector_key("from", Unit::length, kRequired, "one end (of a body: world; of a part: body frame)"),
      vector_key("to", Unit::length, kRequired, "the other end"),
      number_key("roll", Unit::angle, 0, "turns its frame about its axis, from z as near to the world's as can be"),
      number_key("radius", Unit::length, kOptional, "of a solid cylinder; default: length / 50"),
      number_key("axial_inertia", Unit::inertia, kOptional,
                 "a rod without thickness, with this inertia about its axis"),
  };
  const Row radius = number_key("radius", Unit::length, kRequired, "its radius");
  const Row length = number_key("length", Unit::length, kRequired, "its length");
  return {table("rod", "a straight rod, its frame in the middle with x along it", joined({mass, rod})),
          table("box", "a solid box", joined({mass, {vector_key("size", Unit::length, kRequired, "its three edges")}})),
          table("cylinder", "a solid cylinder along z", joined({mass, {radius, length}})),
          table("sphere", "a solid sphere", joined({mass, {radius}}))};
}

SceneTable inertia() {
  Rows rows;
  for (const std::string entry : {"xx", "yy", "zz", "xy", "yz", "zx"})
    rows.push_back(number_key(entry, Unit::inertia, entry[0] == entry[1] ? Default(kRequired) : Default(0),
                              "entry of the inertia matrix"));
  return table("inertia", "an inertia matrix by its entries; products as matrix entries, J_xy = -integral of x y dm",
               rows);
}

SceneTable visual() {
  return table("visual", "what a body looks like in reports, beside its shape",
               {
                   text_key("color", kOptional, "\"#rrggbb\"; default: the next of a palette"),
                   number_key("opacity", Unit::none, 1, "from 0, glass, to 1, solid"),
                   flag_key("own_shape", true, "whether the shape that gives its mass is drawn, too"),
                   any_key("shapes", Holds::objects, "visual_shape", "further shapes and meshes, without mass"),
               });
}

SceneTable visual_shape() {
  return table(
      "visual_shape", "a shape that is drawn and weighs nothing",
      {
          any_key("rod", Holds::object, "rod", "a rod from one point to another, body frame"),
          any_key("box", Holds::object, "box", "a box about its frame's origin"),
          any_key("cylinder", Holds::object, "cylinder", "a cylinder about its frame's origin, along z"),
          any_key("sphere", Holds::object, "sphere", "a sphere about its frame's origin"),
          text_key("mesh", kOptional, "file of a mesh, STL or OBJ; path from the scene's folder"),
          number_key("scale", Unit::none, 1, "factor on the mesh's points: 0.001 of one in mm; below 0: mirrored"),
          vector_key("at", Unit::length, zero(), "origin of its frame, body frame"),
          axes_key("orientation", unturned(), "its axes, in the body frame"),
      });
}

SceneTable marker() {
  return table("marker", "a frame on a body, fixed there or moved by laws",
               {
                   text_key("name", kRequired, "its name, unique in the scene"),
                   text_key("body", kRequired, "the body that carries it"),
                   vector_key("at", Unit::length, kOptional, "its origin, body frame"),
                   axes_key("orientation", kOptional, "its axes, in the body frame"),
                   vector_key("world_at", Unit::length, kOptional, "its origin at the start, world"),
                   axes_key("world_orientation", kOptional, "its axes at the start, in the world"),
                   law_key("translation", Form::translation_law, Unit::length, "moves it along its own home axes"),
                   law_key("rotation", Form::rotation_law, Unit::angle, "turns it about them"),
               });
}

// The keys that place a link or a force.
Rows attachment_keys() {
  return {
      text_key("p", kOptional, "the marker P, or a body that is given one"),
      text_key("s", kOptional, "the marker S that P is seen from, or a body that is given one"),
      vector_key("at", Unit::length, kOptional, "where both new markers are at the start, world"),
      vector_key("at_p", Unit::length, kOptional, "where the new marker P is at the start, world"),
      vector_key("at_s", Unit::length, kOptional, "where the new marker S is at the start, world"),
      {{"axis", Form::axis, Unit::none, kOptional, "z axis of the new markers at the start, world"}},
      axes_key("orientation", kOptional, "axes of the new markers at the start, in the world"),
  };
}

// Name and type of a thing whose types are on a shelf.
Rows typed_keys(const std::string& shelf) {
  return {text_key("name", kRequired, "its name, unique in the scene"),
          text_key("type", kRequired, "what it is: see `lockstep list " + shelf + "`")};
}

SceneTable link() {
  const Rows more = {
      any_key("pairs", Holds::texts_or_objects, "pair",
              "in place of p and s: links whose markers it couples, by name, or {\"p\":, \"s\":, ...} each"),
      any_key("drive", Holds::object_or_list, "drive", "laws on coordinates that the link leaves free"),
      law_key("move", Form::translation_law, Unit::length, "where P is held, S axes, on the rows x y z"),
      law_key("turn", Form::rotation_law, Unit::angle, "how far P is held turned against S"),
      flag_key("active", true, "whether it holds from the start"),
      flag_key("hold", false,
               "whether it closes where its bodies stand: what its mask holds then is P as it stands against S at that "
               "instant"),
      any_key("start", Holds::object, "start", "how its free coordinates begin"),
      any_key("unilateral", Holds::object, "unilateral", "its one row may push but not pull: C >= 0 instead of C = 0"),
      any_key("stops", Holds::objects, "travel",
              "ends of the travel of its free coordinates; links named \"A.stop_rz_low\", ..."),
      any_key("friction", Holds::object, "friction", "friction from its own reaction; a force named \"A.friction\""),
  };
  return table("link", "a joint, a lock or any other constraint between bodies",
               joined({typed_keys("links"), attachment_keys(), more}), "links");
}

SceneTable pair() { return table("pair", "two markers whose relative motion is coupled", attachment_keys()); }

SceneTable force() {
  return table("force", "an applied force: it pushes or pulls, but does not hold",
               joined({typed_keys("forces"),
                       attachment_keys(),
                       {text_key("link", kOptional, "the link in which it acts, for friction"),
                        flag_key("active", true, "whether it acts from the start")}}),
               "forces");
}

const Words kAxes = {"x", "y", "z", "rx", "ry", "rz"};

std::vector<SceneTable> unilateral_parts() {
  const Rows bounce = {
      number_key("restitution", Unit::none, 0, "ratio of the speed after an impact to that before, 0 to 1"),
      number_key("rest_speed", Unit::any, 0.001, "impacts that leave less end at rest, m/s or rad/s"),
  };
  const Rows travel = {
      choice_key("axis", kRequired, kAxes, "the coordinate of P seen from S"),
      number_key("low", Unit::any, kOptional, "its lowest value, m or rad"),
      number_key("high", Unit::any, kOptional, "its highest value, m or rad"),
  };
  const Row side =
      choice_key("side", "above", {"above", "below"}, "where its row is free: C >= 0, or C <= 0 as for a rope");
  const TypeInfo& friction = JointFriction::info();
  return {table("unilateral", "impacts of a link that may push but not pull", joined({bounce, {side}})),
          table("travel", "where the travel of one coordinate of a link ends", joined({travel, bounce})),
          {{"friction", friction.help, friction.keys}}};
}

std::vector<SceneTable> link_parts() {
  Rows velocity, position;
  for (const std::string& axis : kAxes) {
    const bool turns = axis.size() > 1;
    const std::string help = (turns ? "about " : "along ") + axis.substr(turns) + " of S";
    velocity.push_back(number_key(axis, turns ? Unit::angular_speed : Unit::speed, kOptional, help));
    position.push_back(number_key(axis, turns ? Unit::angle : Unit::length, kOptional, help));
  }
  const Rows drive = {
      choice_key("axis", kRequired, kAxes, "the coordinate of P seen from S"),
      law_key("law", Form::law, Unit::any, "the coordinate as a function of time, m or rad"),
      law_key("speed", Form::law, Unit::any,
              "its speed as a function of time, m/s or rad/s; the coordinate is integrated"),
  };
  const Rows start = {
      any_key("velocity", Holds::object, "start_velocity", "their speeds"),
      any_key("position", Holds::object, "start_position", "their values, exactly"),
      any_key("near", Holds::object, "start_position", "their values, as near as all else that is asked for allows"),
  };
  return {table("drive", "a law on one free coordinate of a link; adds exactly one row", drive),
          table("start", "how the free coordinates of a link begin", start),
          table("start_velocity", "speeds of P against S at the start, S axes", velocity),
          table("start_position", "coordinates of P against S at the start, S axes", position)};
}

std::vector<SceneTable> events() {
  return {table("event", "a change of the links and forces that act, between two steps",
                {
                    text_key("name", kRequired, "its name, unique among events"),
                    number_key("at", Unit::time, kOptional, "the instant; or \"when\""),
                    any_key("when", Holds::object, "condition", "the condition; or \"at\""),
                    any_key("activate", Holds::texts, "", "links and forces that begin to act"),
                    any_key("deactivate", Holds::texts, "", "links and forces that stop acting"),
                    flag_key("stop", false, "whether the run ends there"),
                    flag_key("once", true, "only the first time that the condition is met"),
                }),
          table("condition", "a channel that crosses a value",
                {
                    text_key("channel", kRequired, "a channel's name, such as \"slider.x\""),
                    number_key("crosses", Unit::any, 0, "the value"),
                    choice_key("direction", "any", {"any", "rising", "falling"}, "the direction of crossing"),
                })};
}

SceneTable run() {
  return table(
      "run", "how the motion is computed and what is written",
      {
          any_key("integrator", Holds::typed, "integrators",
                  "a name of `lockstep list integrators`, or {\"type\": name, and its keys}; default \"dopri5\""),
          number_key("step", Unit::time, kOptional, "fixed step, or the largest step of an adaptive integrator"),
          number_key("tolerance", Unit::none, 1e-6,
                     "relative tolerance of adaptive integrators; absolute: a hundredth of it, m"),
          number_key("until", Unit::time, kOptional, "end of the run; 0: its start alone, one row"),
          number_key("output", Unit::time, kOptional, "interval of the recorded instants; default: every step"),
          {{"times", Form::numbers, Unit::time, kOptional, "or these instants, rising"}},
          number_key("energy_limit", Unit::none, 1e-3,
                     "an energy balance off by more, relative to the energy exchanged, is an error of the run"),
          number_key("violation_limit", Unit::length, kOptional,
                     "a larger violation of the constraints is an error of the run; default: a thousandth of the "
                     "mechanism's size"),
          integer_key("max_steps", kOptional, "the run ends with an error after so many steps"),
          choice_key(
              "formulation", "auto", formulation_names(),
              "unknowns: 6 velocities per body, the paper's 7 coordinates, or the coordinates of the joints; auto: of "
              "the joints where that costs less and no solver is named, else omega"),
          any_key("stabilization", Holds::choice_or_object, "stabilization",
                  "how drift off the constraints is corrected; default \"project\"", {"project", "baumgarte", "none"}),
          any_key("solver", Holds::typed, "solvers",
                  "a name of `lockstep list solvers`, or {\"type\": name, and its keys}; default \"schur\", with "
                  "formulation quaternion \"sparse\""),
          choice_key(
              "nearly_redundant", "auto", {"auto", "told", "free", "held"},
              "rows that depend on others but for a singular value below 1e-3, as of two hinges whose axes nearly "
              "agree: held, left out (free), or told and not decided; auto: held as they are written, and told where "
              "that cannot be"),
          flag_key("assemble", true, "a start off the constraints is moved onto them"),
          any_key("record", Holds::channels, "", "the channels, by name or as {\"own name\": \"channel\"}"),
          any_key("draw", Holds::text_lists, "",
                  "panels of the picture from top to bottom, each a list of recorded names; default: by unit"),
          any_key("pictures", Holds::objects, "picture", "more pictures, each of one recorded column against another"),
          choice_key("headers", "units", {"units", "plain"},
                     "names of the columns in the CSV file, with their units, \"x [m]\", or plain, \"x\""),
          flag_key("at_jumps", false, "rows also just before and just after events, impacts and jumps of laws"),
      });
}

std::vector<SceneTable> run_parts() {
  return {table("picture", "a picture of one column against another, as the path of a point; lengths have equal scales",
                {
                    text_key("x", kRequired, "the column of the x axis, by its recorded name; \"t\": the time"),
                    text_key("y", kRequired, "the column of the y axis"),
                }),
          table("stabilization", "how drift off the constraints is corrected",
                {
                    choice_key("kind", "project", {"project", "baumgarte", "none"}, "the method"),
                    number_key("alpha", Unit::frequency, 5, "Baumgarte's damping rate, 1/s"),
                    number_key("beta", Unit::frequency, 5, "Baumgarte's stiffness rate, 1/s"),
                    number_key("tolerance", Unit::length, 1e-10, "of the constraints, m"),
                })};
}

std::vector<SceneTable> all_tables() {
  std::vector<SceneTable> all = {scene(),  include(),      repeat(), body(), part(), inertia(),
                                 visual(), visual_shape(), marker(), link(), pair(), force()};
  for (const auto& group : {shapes(), link_parts(), unilateral_parts(), events(), {run()}, run_parts()})
    all.insert(all.end(), group.begin(), group.end());
  for (const SceneTable& table : all) check_type_info(table.info);
  return all;
}

}  // namespace

const std::vector<SceneTable>& scene_tables() {
  static const std::vector<SceneTable> kTables = all_tables();
  return kTables;
}

const SceneTable& scene_table(const std::string& name) {
  for (const SceneTable& table : scene_tables())
    if (table.info.name == name) return table;
  assert(false && "no such table of the scene");
  return scene_tables().front();
}

}  // namespace lockstep
