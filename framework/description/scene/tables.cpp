#include "framework/description/scene/tables.h"

#include <cassert>
#include <utility>

#include <lockstep/dynamics.h>
#include <lockstep/forces.h>

namespace lockstep {
namespace {

Key any(std::string name, std::string help, std::vector<std::string> choices = {}) {
  return {std::move(name), Form::any, Unit::none, kOptional, std::move(help), std::move(choices)};
}
Key name_key(std::string help) { return {"name", Form::text, Unit::none, kRequired, std::move(help)}; }

SceneTable scene() {
  return {
      {"scene",
       "a mechanism, how it starts, how it runs and what is recorded",
       {{"lockstep", Form::integer, Unit::none, kRequired, "version of this format: 1"},
        {"$schema", Form::text, Unit::none, kOptional, "the JSON schema, for editors"},
        {"title", Form::text, Unit::none, kOptional, "one line that says what moves"},
        {"description", Form::text, Unit::none, kOptional, "more about it"},
        any("parameters",
            "numbers and quantities by name: {\"crank\": \"100 mm\", \"ratio\": 2.5}; \"=crank*cos(30 deg)\" stands "
            "wherever a number does, here too"),
        any("points",
            "points by name, world: {\"A\": [0, 0, 0], \"B\": \"=A + [crank, 0, 0]\"}; \"at\", \"from\", \"to\", "
            "\"position\" of bodies, markers and links take a name"),
        any("requires", "plugins that must be loaded, by bare name; no path"),
        {"gravity", Form::vector3, Unit::acceleration, Value::List{0, 0, 0}, "gravity, world axes"},
        {"planar",
         Form::choice,
         Unit::none,
         "auto",
         "normal of the plane of all motion: three velocities per body; \"auto\": where that is exact and all links, "
         "laws and forces are known to stay in it (without the key, only where joint coordinates do not serve)",
         {"off", "auto", "x", "y", "z"}},
        {"merge",
         Form::choice,
         Unit::none,
         "off",
         "\"auto\": bodies joined by a fixed link without a law move as one; links that are recorded, or that "
         "events name, stay",
         {"off", "auto"}},
        any("include", "other scenes as parts of this one"),
        any("repeat", "parts of the scene several times, with an index"),
        any("set",
            "other values of what included and repeated parts bring, by path: {\"bodies.left_leg.rod.mass\": 2}"),
        any("bodies", "the bodies; \"ground\" always exists"),
        any("markers", "frames on bodies that links and forces name"),
        any("links", "what holds the bodies together"),
        any("forces", "the forces applied to them"),
        any("events", "changes of the links in force during the run"),
        any("run", "integrator, duration, output")}},
      {{"parameters", Holds::quantities},
       {"points", Holds::named_points},
       {"requires", Holds::texts},
       {"include", Holds::objects, "include"},
       {"repeat", Holds::objects, "repeat"},
       {"set", Holds::settings},
       {"bodies", Holds::objects, "body"},
       {"markers", Holds::objects, "marker"},
       {"links", Holds::objects, "link"},
       {"forces", Holds::objects, "force"},
       {"events", Holds::objects, "event"},
       {"run", Holds::object, "run"}}};
}

SceneTable include() {
  return {{"include",
           "another scene as a part of this one: its points, bodies, markers, links, forces and events",
           {{"scene", Form::text, Unit::none, kRequired, "its file, from the folder of this scene"},
            {"prefix", Form::text, Unit::none, "", "put before its names, as in \"left_\""},
            {"at", Form::vector3, Unit::length, Value::List{0, 0, 0}, "where its origin is put, world"},
            {"orientation", Form::orientation, Unit::none, Value::List{1, 0, 0, 0},
             "how its axes are turned, in the world; gravity is this scene's"},
            any("parameters", "other values of its parameters; formulas are of this scene's")}},
          {{"parameters", Holds::quantities}}};
}

SceneTable repeat() {
  return {{"repeat",
           "parts of a scene, several times; \"{i}\" and \"{i+1}\" in texts become whole numbers, i in formulas is one",
           {{"times", Form::integer, Unit::none, kRequired, "how many times"},
            {"index", Form::text, Unit::none, "i", "name of the index"},
            {"from", Form::integer, Unit::none, 0, "its first value"},
            any("points", "added to those of the scene"),
            any("bodies", "likewise"),
            any("markers", "likewise"),
            any("links", "likewise, behind those of the scene"),
            any("forces", "likewise")}},
          {{"points", Holds::named_points},
           {"bodies", Holds::objects, "body"},
           {"markers", Holds::objects, "marker"},
           {"links", Holds::objects, "link"},
           {"forces", Holds::objects, "force"}}};
}

// The keys that give mass, the same for a body and for a part of a compound.
Keys mass_keys() {
  return {
      {"mass", Form::number, Unit::mass, kOptional, "mass, given with \"inertia\""},
      any("inertia", "[Jxx, Jyy, Jzz], {\"xx\":, ..., \"xy\":}, or three rows; products as matrix entries"),
      any("inertia_at", "point about which the inertia is given, own frame", {"center"}),
      {"inertia_axes", Form::orientation, Unit::none, Value::List{1, 0, 0, 0}, "axes of the inertia, in its own frame"},
      {"center", Form::vector3, Unit::length, Value::List{0, 0, 0}, "mass centre, own frame"},
      any("rod", "a rod; it defines the frame: in its middle, x along it"),
      any("box", "a box about its frame's origin"),
      any("cylinder", "a cylinder about its frame's origin, along z"),
      any("sphere", "a sphere about its frame's origin")};
}
std::vector<Part> mass_parts() {
  return {{"inertia", Holds::vector_or_object, "inertia"},
          {"inertia_at", Holds::vector_or_word},
          {"rod", Holds::object, "rod"},
          {"box", Holds::object, "box"},
          {"cylinder", Holds::object, "cylinder"},
          {"sphere", Holds::object, "sphere"}};
}

Keys joined(Keys all, const Keys& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

SceneTable body() {
  SceneTable t{{"body", "a rigid body, a particle or a fixed frame", {name_key("its name, unique in the scene")}},
               mass_parts()};
  const Keys more = {
      any("compound", "several parts, rigidly joined, each placed in the body's frame"),
      {"particle", Form::number, Unit::mass, kOptional, "mass of a particle, which has no rotation"},
      {"fixed", Form::boolean, Unit::none, false, "it never moves and needs no mass"},
      {"position", Form::vector3, Unit::length, Value::List{0, 0, 0}, "origin of its frame at the start, world"},
      {"orientation", Form::orientation, Unit::none, Value::List{1, 0, 0, 0}, "its axes at the start, in the world"},
      {"velocity", Form::vector3, Unit::speed, Value::List{0, 0, 0}, "of the frame's origin at the start, world axes"},
      {"omega_body", Form::vector3, Unit::angular_speed, kOptional, "angular velocity at the start, body axes"},
      {"omega_world", Form::vector3, Unit::angular_speed, kOptional, "angular velocity at the start, world axes"},
      {"assembled",
       Form::choice,
       Unit::none,
       "approximate",
       "what assembling the start may do to its pose: as little as the rest allows, nothing, or anything",
       {"approximate", "exact", "free"}},
      {"start_weight", Form::number, Unit::none, 1, "how much its start pose counts against those of others"},
      any("visual", "what it looks like in reports")};
  t.info.keys = joined(joined(std::move(t.info.keys), mass_keys()), more);
  t.parts.push_back({"compound", Holds::objects, "part"});
  t.parts.push_back({"visual", Holds::object, "visual"});
  return t;
}

SceneTable part() {
  SceneTable t{{"part", "a part of a compound body", mass_keys()}, mass_parts()};
  t.info.keys.push_back(
      {"position", Form::vector3, Unit::length, Value::List{0, 0, 0}, "origin of the part's frame, body frame"});
  t.info.keys.push_back(
      {"orientation", Form::orientation, Unit::none, Value::List{1, 0, 0, 0}, "axes of the part, in the body frame"});
  return t;
}

Key shape_mass() { return {"mass", Form::number, Unit::mass, kOptional, "mass; or \"density\""}; }
Key shape_density() { return {"density", Form::number, Unit::density, kOptional, "mass by volume; or \"mass\""}; }
Key length_key(std::string name, std::string help) {
  return {std::move(name), Form::number, Unit::length, kRequired, std::move(help)};
}

std::vector<SceneTable> shapes() {
  return {{{"rod",
            "a straight rod, its frame in the middle with x along it",
            {shape_mass(),
             shape_density(),
             {"from", Form::vector3, Unit::length, kRequired, "one end (of a body: world; of a part: body frame)"},
             {"to", Form::vector3, Unit::length, kRequired, "the other end"},
             {"roll", Form::number, Unit::angle, 0,
              "turns its frame about its axis, from z as near to the world's as can be"},
             {"radius", Form::number, Unit::length, kOptional, "of a solid cylinder; default: length / 50"},
             {"axial_inertia", Form::number, Unit::inertia, kOptional,
              "a rod without thickness, with this inertia about its axis"}}}},
          {{"box",
            "a solid box",
            {shape_mass(), shape_density(), {"size", Form::vector3, Unit::length, kRequired, "its three edges"}}}},
          {{"cylinder",
            "a solid cylinder along z",
            {shape_mass(), shape_density(), length_key("radius", "its radius"), length_key("length", "its length")}}},
          {{"sphere", "a solid sphere", {shape_mass(), shape_density(), length_key("radius", "its radius")}}}};
}

SceneTable inertia() {
  const auto entry = [](const char* name, Default fallback) {
    return Key{name, Form::number, Unit::inertia, std::move(fallback), "entry of the inertia matrix"};
  };
  return {{"inertia",
           "an inertia matrix by its entries; products as matrix entries, J_xy = -integral of x y dm",
           {entry("xx", kRequired), entry("yy", kRequired), entry("zz", kRequired), entry("xy", 0), entry("yz", 0), entry("zx", 0)}}};
}

SceneTable visual() {
  return {{"visual",
           "what a body looks like in reports, beside its shape",
           {{"color", Form::text, Unit::none, kOptional, "\"#rrggbb\"; default: the next of a palette"},
            {"opacity", Form::number, Unit::none, 1, "from 0, glass, to 1, solid"},
            {"own_shape", Form::boolean, Unit::none, true, "whether the shape that gives its mass is drawn, too"},
            any("shapes", "further shapes and meshes, without mass")}},
          {{"shapes", Holds::objects, "visual_shape"}}};
}

SceneTable visual_shape() {
  return {
      {"visual_shape",
       "a shape that is drawn and weighs nothing",
       {any("rod", "a rod from one point to another, body frame"),
        any("box", "a box about its frame's origin"),
        any("cylinder", "a cylinder about its frame's origin, along z"),
        any("sphere", "a sphere about its frame's origin"),
        {"mesh", Form::text, Unit::none, kOptional, "file of a mesh, STL or OBJ; path from the scene's folder"},
        {"scale", Form::number, Unit::none, 1, "factor on the mesh's points: 0.001 of one in mm; below 0: mirrored"},
        {"at", Form::vector3, Unit::length, Value::List{0, 0, 0}, "origin of its frame, body frame"},
        {"orientation", Form::orientation, Unit::none, Value::List{1, 0, 0, 0}, "its axes, in the body frame"}}},
      {{"rod", Holds::object, "rod"},
       {"box", Holds::object, "box"},
       {"cylinder", Holds::object, "cylinder"},
       {"sphere", Holds::object, "sphere"}}};
}

SceneTable marker() {
  return {{"marker",
           "a frame on a body, fixed there or moved by laws",
           {name_key("its name, unique in the scene"),
            {"body", Form::text, Unit::none, kRequired, "the body that carries it"},
            {"at", Form::vector3, Unit::length, kOptional, "its origin, body frame"},
            {"orientation", Form::orientation, Unit::none, kOptional, "its axes, in the body frame"},
            {"world_at", Form::vector3, Unit::length, kOptional, "its origin at the start, world"},
            {"world_orientation", Form::orientation, Unit::none, kOptional, "its axes at the start, in the world"},
            {"translation", Form::translation_law, Unit::length, kOptional, "moves it along its own home axes"},
            {"rotation", Form::rotation_law, Unit::angle, kOptional, "turns it about them"}}}};
}

// The keys that place a link or a force.
Keys attachment_keys(Default p_default) {
  return {
      {"p", Form::text, Unit::none, p_default, "the marker P, or a body that is given one"},
      {"s", Form::text, Unit::none, p_default, "the marker S that P is seen from, or a body that is given one"},
      {"at", Form::vector3, Unit::length, kOptional, "where both new markers are at the start, world"},
      {"at_p", Form::vector3, Unit::length, kOptional, "where the new marker P is at the start, world"},
      {"at_s", Form::vector3, Unit::length, kOptional, "where the new marker S is at the start, world"},
      {"axis", Form::axis, Unit::none, kOptional, "z axis of the new markers at the start, world"},
      {"orientation", Form::orientation, Unit::none, kOptional, "axes of the new markers at the start, in the world"}};
}

SceneTable link() {
  SceneTable t{{"link",
                "a joint, a lock or any other constraint between bodies",
                {name_key("its name, unique in the scene"),
                 {"type", Form::text, Unit::none, kRequired, "what it is: see `lockstep list links`"}}},
               {{"drive", Holds::object_or_list, "drive"},
                {"start", Holds::object, "start"},
                {"pairs", Holds::texts_or_objects, "pair"},
                {"unilateral", Holds::object, "unilateral"},
                {"stops", Holds::objects, "travel"},
                {"friction", Holds::object, "friction"}},
               "links"};
  const Keys more = {
      any("pairs", "in place of p and s: links whose markers it couples, by name, or {\"p\":, \"s\":, ...} each"),
      any("drive", "laws on coordinates that the link leaves free"),
      {"move", Form::translation_law, Unit::length, kOptional, "where P is held, S axes, on the rows x y z"},
      {"turn", Form::rotation_law, Unit::angle, kOptional, "how far P is held turned against S"},
      {"active", Form::boolean, Unit::none, true, "whether it holds from the start"},
      {"hold", Form::boolean, Unit::none, false,
       "whether it closes where its bodies stand: what its mask holds then is P as it stands against S at that "
       "instant"},
      any("start", "how its free coordinates begin"),
      any("unilateral", "its one row may push but not pull: C >= 0 instead of C = 0"),
      any("stops", "ends of the travel of its free coordinates; links named \"A.stop_rz_low\", ..."),
      any("friction", "friction from its own reaction; a force named \"A.friction\"")};
  t.info.keys = joined(joined(std::move(t.info.keys), attachment_keys(kOptional)), more);
  return t;
}

SceneTable pair() {
  return {{"pair", "two markers whose relative motion is coupled", attachment_keys(kOptional)}};
}

SceneTable force() {
  SceneTable t{{"force",
                "an applied force: it pushes or pulls, but does not hold",
                joined({name_key("its name, unique in the scene"),
                        {"type", Form::text, Unit::none, kRequired, "what it is: see `lockstep list forces`"}},
                       attachment_keys(kOptional))},
               {},
               "forces"};
  t.info.keys.push_back({"link", Form::text, Unit::none, kOptional, "the link in which it acts, for friction"});
  t.info.keys.push_back({"active", Form::boolean, Unit::none, true, "whether it acts from the start"});
  return t;
}

Keys bounce_keys() {
  return {{"restitution", Form::number, Unit::none, 0, "ratio of the speed after an impact to that before, 0 to 1"},
          {"rest_speed", Form::number, Unit::any, 0.001, "impacts that leave less end at rest, m/s or rad/s"}};
}

std::vector<SceneTable> unilateral_parts() {
  SceneTable unilateral{{"unilateral", "impacts of a link that may push but not pull", bounce_keys()}};
  unilateral.info.keys.push_back({"side",
                                  Form::choice,
                                  Unit::none,
                                  "above",
                                  "where its row is free: C >= 0, or C <= 0 as for a rope",
                                  {"above", "below"}});
  SceneTable travel{
      {"travel",
       "where the travel of one coordinate of a link ends",
       {{"axis", Form::choice, Unit::none, kRequired, "the coordinate of P seen from S", {"x", "y", "z", "rx", "ry", "rz"}},
        {"low", Form::number, Unit::any, kOptional, "its lowest value, m or rad"},
        {"high", Form::number, Unit::any, kOptional, "its highest value, m or rad"}}}};
  for (Key& key : bounce_keys()) travel.info.keys.push_back(std::move(key));
  const TypeInfo& friction = JointFriction::info();
  return {unilateral, travel, {{"friction", friction.help, friction.keys}}};
}

std::vector<SceneTable> link_parts() {
  SceneTable velocity{{"start_velocity", "speeds of P against S at the start, S axes", {}}};
  SceneTable position{{"start_position", "coordinates of P against S at the start, S axes", {}}};
  for (const std::string axis : {"x", "y", "z", "rx", "ry", "rz"}) {
    const bool turns = axis.size() > 1;
    const std::string help = (turns ? "about " : "along ") + axis.substr(turns) + " of S";
    velocity.info.keys.push_back({axis, Form::number, turns ? Unit::angular_speed : Unit::speed, kOptional, help});
    position.info.keys.push_back({axis, Form::number, turns ? Unit::angle : Unit::length, kOptional, help});
  }
  return {{{"drive",
            "a law on one free coordinate of a link; adds exactly one row",
            {{"axis",
              Form::choice,
              Unit::none,
              kRequired,
              "the coordinate of P seen from S",
              {"x", "y", "z", "rx", "ry", "rz"}},
             {"law", Form::law, Unit::any, kOptional, "the coordinate as a function of time, m or rad"},
             {"speed", Form::law, Unit::any, kOptional,
              "its speed as a function of time, m/s or rad/s; the coordinate is integrated"}}}},
          {{"start",
            "how the free coordinates of a link begin",
            {any("velocity", "their speeds"), any("position", "their values, exactly"),
             any("near", "their values, as near as all else that is asked for allows")}},
           {{"velocity", Holds::object, "start_velocity"},
            {"position", Holds::object, "start_position"},
            {"near", Holds::object, "start_position"}}},
          velocity,
          position};
}

std::vector<SceneTable> events() {
  return {
      {{"event",
        "a change of the links and forces that act, between two steps",
        {name_key("its name, unique among events"),
         {"at", Form::number, Unit::time, kOptional, "the instant; or \"when\""},
         any("when", "the condition; or \"at\""),
         any("activate", "links and forces that begin to act"),
         any("deactivate", "links and forces that stop acting"),
         {"stop", Form::boolean, Unit::none, false, "whether the run ends there"},
         {"once", Form::boolean, Unit::none, true, "only the first time that the condition is met"}}},
       {{"when", Holds::object, "condition"}, {"activate", Holds::texts}, {"deactivate", Holds::texts}}},
      {{"condition",
        "a channel that crosses a value",
        {{"channel", Form::text, Unit::none, kRequired, "a channel's name, such as \"slider.x\""},
         {"crosses", Form::number, Unit::any, 0, "the value"},
         {"direction", Form::choice, Unit::none, "any", "the direction of crossing", {"any", "rising", "falling"}}}}}};
}

std::vector<SceneTable> runs() {
  return {
      {{"run",
        "how the motion is computed and what is written",
        {any("integrator",
             "a name of `lockstep list integrators`, or {\"type\": name, and its keys}; default \"dopri5\""),
         {"step", Form::number, Unit::time, kOptional, "fixed step, or the largest step of an adaptive integrator"},
         {"tolerance", Form::number, Unit::none, 1e-6,
          "relative tolerance of adaptive integrators; absolute: a hundredth of it, m"},
         {"until", Form::number, Unit::time, kOptional, "end of the run; 0: its start alone, one row"},
         {"output", Form::number, Unit::time, kOptional, "interval of the recorded instants; default: every step"},
         {"times", Form::numbers, Unit::time, kOptional, "or these instants, rising"},
         {"energy_limit", Form::number, Unit::none, 1e-3,
          "an energy balance off by more, relative to the energy exchanged, is an error of the run"},
         {"violation_limit", Form::number, Unit::length, kOptional,
          "a larger violation of the constraints is an error of the run; default: a thousandth of the mechanism's "
          "size"},
         {"max_steps", Form::integer, Unit::none, kOptional, "the run ends with an error after so many steps"},
         {"formulation", Form::choice, Unit::none, "auto",
          "unknowns: 6 velocities per body, the paper's 7 coordinates, or the coordinates of the joints; auto: of the "
          "joints where that costs less and no solver is named, else omega",
          formulation_names()},
         any("stabilization", "how drift off the constraints is corrected; default \"project\"",
             {"project", "baumgarte", "none"}),
         any("solver",
             "a name of `lockstep list solvers`, or {\"type\": name, and its keys}; default \"schur\", with "
             "formulation quaternion \"sparse\""),
         {"nearly_redundant",
          Form::choice,
          Unit::none,
          "auto",
          "rows that depend on others but for a singular value below 1e-3, as of two hinges whose axes nearly agree: "
          "held, left out (free), or told and not decided; auto: held as they are written, and told where that cannot "
          "be",
          {"auto", "told", "free", "held"}},
         {"assemble", Form::boolean, Unit::none, true, "a start off the constraints is moved onto them"},
         any("record", "the channels, by name or as {\"own name\": \"channel\"}"),
         any("draw", "panels of the picture from top to bottom, each a list of recorded names; default: by unit"),
         any("pictures", "more pictures, each of one recorded column against another"),
         {"headers",
          Form::choice,
          Unit::none,
          "units",
          "names of the columns in the CSV file, with their units, \"x [m]\", or plain, \"x\"",
          {"units", "plain"}},
         {"at_jumps", Form::boolean, Unit::none, false,
          "rows also just before and just after events, impacts and jumps of laws"}}},
       {{"integrator", Holds::typed, "integrators"},
        {"stabilization", Holds::choice_or_object, "stabilization"},
        {"solver", Holds::typed, "solvers"},
        {"record", Holds::channels},
        {"draw", Holds::text_lists},
        {"pictures", Holds::objects, "picture"}}},
      {{"picture",
        "a picture of one column against another, as the path of a point; lengths have equal scales",
        {{"x", Form::text, Unit::none, kRequired, "the column of the x axis, by its recorded name; \"t\": the time"},
         {"y", Form::text, Unit::none, kRequired, "the column of the y axis"}}}},
      {{"stabilization",
        "how drift off the constraints is corrected",
        {{"kind", Form::choice, Unit::none, "project", "the method", {"project", "baumgarte", "none"}},
         {"alpha", Form::number, Unit::frequency, 5, "Baumgarte's damping rate, 1/s"},
         {"beta", Form::number, Unit::frequency, 5, "Baumgarte's stiffness rate, 1/s"},
         {"tolerance", Form::number, Unit::length, 1e-10, "of the constraints, m"}}}}};
}

std::vector<SceneTable> all_tables() {
  std::vector<SceneTable> all = {scene(),  include(),      repeat(), body(), part(), inertia(),
                                 visual(), visual_shape(), marker(), link(), pair(), force()};
  for (const auto& group : {shapes(), link_parts(), unilateral_parts(), events(), runs()})
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
