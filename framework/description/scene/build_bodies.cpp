// SPDX-License-Identifier: BSD-3-Clause
// Bodies and markers of a scene.

#include <lockstep/body.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/csv_reader.h"

namespace lockstep {
namespace {

constexpr double kLeastDensity = 1e-3;  // kg/m^3

// Those of the keys that are given.
std::vector<std::string> given(const Params& p, const std::vector<std::string>& keys) {
  std::vector<std::string> found;
  for (const std::string& key : keys)
    if (p.has(key)) found.push_back(key);
  return found;
}

void refuse_beside(const Params& p, const std::string& why, const std::vector<std::string>& keys) {
  for (const std::string& key : given(p, keys)) p.refuse(key, why + "; remove \"" + key + "\"");
}

// Mass of a shape of this volume.
double shape_mass(const Params& shape, double volume) {
  if (shape.has("mass") == shape.has("density"))
    shape.refuse(
        shape.has("mass") ? "density" : "mass",
        "give either \"mass\" or \"density\", " + std::string(shape.has("mass") ? "not both" : "neither is given"));
  return shape.has("mass") ? positive(shape, "mass", "mass") : positive(shape, "density", "density") * volume;
}

double rod_length(const Params& rod) { return (rod.vector3("to") - rod.vector3("from")).norm(); }

void check_lengths(const Params& shape, const std::string& kind) {
  if (kind == "rod" && !(rod_length(shape) > 0))
    shape.refuse("to", "both ends are at the same point; a rod needs a length");
  if (const double least = kind == "box" ? shape.vector3("size").minCoeff() : 1; !(least > 0))
    shape.refuse("size", "an edge is " + text::number(least) + " m; all three must be greater than 0");
  for (const char* length : {"radius", "length"})
    if (shape.has(length)) positive(shape, length, length);
}

Shape read_rod(const Params& rod) {
  const Vec3 from = rod.vector3("from"), to = rod.vector3("to");
  const double length = rod_length(rod), radius = rod.has("radius") ? rod.number("radius") : length / 50;
  const double mass = shape_mass(rod, cylinder_volume(radius, length));
  const bool slender = rod.has("axial_inertia");
  if (slender) refuse_beside(rod, "\"axial_inertia\" makes a rod without thickness", {"radius", "density"});
  Shape shape = slender ? shapes::slender_rod(mass, from, to, positive(rod, "axial_inertia", "inertia"))
                        : shapes::rod(mass, from, to, radius);
  // mass and inertia stay: it is round
  if (rod.has("roll")) shape.home.q = shape.home.q * axis_angle(Vec3::UnitX(), rod.number("roll"));
  return shape;
}

MassProperties read_solid(const Params& solid, const std::string& kind) {
  if (kind == "box") {
    const Vec3 size = solid.vector3("size");
    return shapes::box(shape_mass(solid, box_volume(size)), size);
  }
  const double radius = solid.number("radius");
  if (kind == "sphere") return shapes::sphere(shape_mass(solid, sphere_volume(radius)), radius);
  const double length = solid.number("length");
  return shapes::cylinder(shape_mass(solid, cylinder_volume(radius, length)), radius, length);
}

// [a, b, c], an object of entries, or three rows.
const Mat3& read_symmetric(const Params& body, const Mat3& J) {
  const Mat3 skew = 0.5 * (J - J.transpose());
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < i; ++k)
      if (std::abs(skew(i, k)) > 1e-10 * J.cwiseAbs().maxCoeff())
        body.refuse("inertia", "the matrix is not symmetric: entry " + std::to_string(i + 1) + std::to_string(k + 1) +
                                   " is " + text::brief(J(i, k)) + " and entry " + std::to_string(k + 1) +
                                   std::to_string(i + 1) + " is " + text::brief(J(k, i)) + " kg m^2; make them equal");
  return J;
}

Mat3 read_inertia(const Params& body) {
  const Value& v = body.value("inertia");
  const std::string place = part_of(body.owner(), "inertia");
  if (v.object() != nullptr) {
    for (const auto& [turned, key] : {std::pair{"xz", "zx"}, {"yx", "xy"}, {"zy", "yz"}})
      if (const Value* found = v.find(turned))
        refuse(found->where, place,
               "unknown key \"" + std::string(turned) + "\"; the matrix is symmetric, its entry is \"" + key + "\"");
    const Params entry = params_under(body, "inertia", "inertia");
    Mat3 J;
    const double xy = entry.number("xy"), yz = entry.number("yz"), zx = entry.number("zx");
    J << entry.number("xx"), xy, zx, xy, entry.number("yy"), yz, zx, yz, entry.number("zz");
    return J;
  }
  if (v.list() != nullptr && v.list()->size() == 3 && v.list()->front().list() != nullptr)
    return read_symmetric(body, read_matrix3(v, Unit::inertia, place));
  if (v.list() == nullptr || v.list()->size() != 3)
    body.refuse(
        "inertia",
        "expected [Jxx, Jyy, Jzz], {\"xx\":, \"yy\":, \"zz\":, \"xy\":, ...} or three rows of three, got " + shown(v));
  return read_vector3(v, Unit::inertia, place).asDiagonal();
}

// A radius of gyration so large for its mass has a wrong unit: the body would be a thousand times lighter than air.
void doubt_inertia(const Params& body, const MassProperties& m) {
  const double radius = std::sqrt(m.J.diagonal().maxCoeff() / m.mass);
  if (m.mass > kLeastDensity * radius * radius * radius) return;
  report_finding({.kind = &finding::implausible,
                  .thing = body.owner(),
                  .message = body.owner() + ": the radius of gyration is " + text::brief(radius) +
                             " m, which is implausible for " + text::brief(m.mass) + " kg",
                  .advice = "check the unit of the inertia: numbers without a unit are in kg m^2",
                  .value = radius,
                  .unit = "m",
                  .place = body.value("inertia").where.text()});
}

// Of a body, or of a part of one, which has no key "particle".
MassProperties read_mass(const Params& body, bool is_part) {
  const double mass = positive(body, "mass", "mass");
  if (!body.has("inertia"))
    body.refuse("mass",
                is_part ? "a part needs an inertia; add \"inertia\", or use a shape (\"rod\", \"box\", ...; a small "
                          "\"sphere\" for a point mass)"
                        : "a rigid body needs an inertia; add \"inertia\", use a shape (\"rod\", \"box\", "
                          "...), or make it a \"particle\"");
  const Vec3 center = body.vector3("center");
  Vec3 origin = center;
  if (const Value& at = body.value("inertia_at"); !at.is_null() && (at.text() == nullptr || *at.text() != "center")) {
    if (at.text() != nullptr) body.refuse("inertia_at", "expected \"center\" or [x, y, z], got " + shown(at));
    origin = read_vector3(at, Unit::length, part_of(body.owner(), "inertia_at"));
  }
  return placed(body.value("inertia").where, [&] {
    const MassProperties m = shapes::about(mass, center, read_inertia(body), origin, body.orientation("inertia_axes"));
    check_mass(m, body.owner());
    doubt_inertia(body, m);
    return m;
  });
}

// A shape for drawing, in its own frame; the keys are checked. A rod without thickness is drawn like any other.
Solid solid_of(const Params& shape, const std::string& kind) {
  if (kind == "box") return {{}, Solid::Kind::box, shape.vector3("size")};
  if (kind == "rod") {
    const double length = rod_length(shape), width = 2 * (shape.has("radius") ? shape.number("radius") : length / 50);
    const Quat z_along_x = axis_angle(Vec3::UnitY(), kPi / 2);
    return {{}, Solid::Kind::cylinder, {width, width, length}, {Vec3::Zero(), z_along_x}};
  }
  const double width = 2 * shape.number("radius");
  if (kind == "sphere") return {{}, Solid::Kind::sphere, {width, width, width}};
  return {{}, Solid::Kind::cylinder, {width, width, shape.number("length")}};
}

using Solids = std::vector<Solid>;

MassProperties read_compound(const Params& body, Solids& solids);

// Mass and, for a rod, the pose of its frame; its shape is added to `solids`. `kind` is the given key: a shape, "compound"
// or "mass".
Shape read_matter(const Params& body, const std::string& kind, Solids& solids, bool is_part = false) {
  if (kind == "mass") return {read_mass(body, is_part), {}};
  refuse_beside(body, "\"" + kind + "\" defines mass and inertia",
                {"mass", "inertia", "inertia_at", "inertia_axes", "center"});
  if (kind == "compound") return {read_compound(body, solids), {}};
  const Params shape = params_under(body, kind, kind);
  const Shape read = placed(body.value(kind).where, [&]() -> Shape {
    check_lengths(shape, kind);
    if (kind == "rod") return read_rod(shape);
    return {read_solid(shape, kind), {}};
  });
  solids.push_back(solid_of(shape, kind));
  return read;
}

// The one of `kinds` that is given; none, or several, are an error.
std::string the_kind(const Params& body, std::vector<std::string> kinds) {
  const std::vector<std::string> found = given(body, kinds);
  for (std::string& kind : kinds) kind = "\"" + kind + "\"";
  if (found.empty()) body.refuse("", "it has no mass; add one of " + text::join(kinds, " or "));
  if (found.size() > 1)
    body.refuse(found[1], "\"" + found[0] + "\" and \"" + found[1] + "\" both define the mass; remove one of the two");
  return found.front();
}

MassProperties read_part(const Value& v, const std::string& owner, Solids& solids) {
  const Params part = params_of(v, "part", owner, nullptr);
  const std::string kind = the_kind(part, {"rod", "box", "cylinder", "sphere", "mass"});
  const std::size_t n_before = solids.size();
  const Shape shape = read_matter(part, kind, solids, true);
  if (kind == "rod") refuse_beside(part, "\"rod\" defines the pose of the part", {"position", "orientation"});
  const Pose pose = kind == "rod" ? shape.home : Pose{part.vector3("position"), part.orientation("orientation")};
  for (std::size_t k = n_before; k < solids.size(); ++k) solids[k].at = pose * solids[k].at;
  return shapes::moved(shape.mass, pose);
}

MassProperties read_compound(const Params& body, Solids& solids) {
  if (items_of(body, "compound").empty()) body.refuse("compound", "the list is empty; give at least one part");
  std::vector<MassProperties> parts;
  for_each_object(body, "compound",
                  [&](const Value& v, const std::string& owner) { parts.push_back(read_part(v, owner, solids)); });
  return shapes::compound(parts);
}

// The weight of its start pose in assembly.
void read_weight(const Params& body, const std::string& name, Mechanism& out) {
  const std::string how = body.text("assembled");
  double weight = body.number("start_weight");
  if (!(weight >= 0)) body.refuse("start_weight", "it must not be below zero; 0 leaves the start pose free");
  if (how != "approximate" && body.has("start_weight"))
    body.refuse("start_weight", "\"assembled\" is \"" + how + "\", which has no weight; remove one of the two");
  if (how == "exact") weight = std::numeric_limits<double>::infinity();
  if (how == "free") weight = 0;
  if (weight != 1) out.assembly.poses.push_back({name, weight});
  const bool moves = body.has("velocity"), turns = body.has("omega_body") || body.has("omega_world");
  if (moves || turns) out.assembly.stated.push_back({name, moves, turns, body.has("omega_world")});
}

// v of the frame's origin (world), w in body axes.
Twist read_start(const Params& body, const Pose& home) {
  if (body.has("omega_body") && body.has("omega_world"))
    body.refuse("omega_world", "\"omega_body\" is given as well; remove one of the two");
  Twist start{body.vector3("velocity"), Vec3::Zero()};
  if (body.has("omega_body")) start.w = body.vector3("omega_body");
  if (body.has("omega_world")) start.w = rotation(home.q).transpose() * body.vector3("omega_world");
  return start;
}

bool is_color(const std::string& text) {
  return text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
}

// The mesh of a file that the scene names, from the folder of the scene file.
Solid read_mesh_solid(const Params& shape, const MeshFiles& meshes) {
  const double scale = shape.number("scale");
  if (scale == 0) shape.refuse("scale", "it is 0; give a factor such as 0.001, for a mesh in millimetres");
  std::shared_ptr<const TriangleMesh> mesh;
  try {
    mesh = meshes.read(path_of_file(shape.value("mesh")));
  } catch (const FileError& error) {
    shape.refuse("mesh", error.what());
  }
  return {{}, Solid::Kind::mesh, Vec3(scale, scale, scale), {}, mesh};
}

// A shape in the frame of its body.
Solid read_visual_shape(const Value& v, const std::string& owner, const MeshFiles& meshes) {
  const Params shape = params_of(v, "visual_shape", owner, nullptr);
  const std::vector<std::string> found = given(shape, {"rod", "box", "cylinder", "sphere", "mesh"});
  if (found.size() != 1)
    refuse(v.where, owner,
           (found.empty() ? "it has no shape" : "\"" + found[0] + "\" and \"" + found[1] + "\" are two shapes") +
               std::string("; give one of \"rod\", \"box\", \"cylinder\", \"sphere\" and \"mesh\""));
  const std::string& kind = found.front();
  const Pose at{shape.vector3("at"), shape.orientation("orientation")};
  Solid solid;
  if (kind == "mesh") {
    solid = read_mesh_solid(shape, meshes);
  } else {
    if (shape.has("scale")) shape.refuse("scale", "a " + kind + " has its own lengths; remove it");
    const Params lengths = params_under(shape, kind, kind);
    refuse_beside(lengths, "a drawn shape has no mass", {"mass", "density", "axial_inertia"});
    refuse_beside(lengths, "a drawn rod is round", {"roll"});
    check_lengths(lengths, kind);
    solid = solid_of(lengths, kind);
    if (kind == "rod")
      solid.at = shapes::rod(1, lengths.vector3("from"), lengths.vector3("to"), 0.5 * solid.size[0]).home * solid.at;
  }
  solid.at = at * solid.at;
  return solid;
}

Look read_look(const Params& visual, const std::string& name) {
  Look look{name, visual.has("color") ? visual.text("color") : "", visual.number("opacity")};
  if (!look.color.empty() && !is_color(look.color))
    visual.refuse("color", "\"" + look.color + "\" is not a colour; write it like \"#0072b2\"");
  if (!(look.opacity >= 0 && look.opacity <= 1))
    visual.refuse("opacity", "it is " + text::brief(look.opacity) + "; give a number from 0 to 1");
  return look;
}

void keep(const std::string& body, const Solids& solids, Mechanism& out) {
  for (Solid solid : solids) {
    solid.body = body;
    out.solids.push_back(std::move(solid));
  }
}

}  // namespace

// Things that name a failed body are built with a substitute, so that their own errors are found too.
void Builder::stand_in(const Value& object, const std::string& /*owner*/) {
  const Value* key = object.find("name");
  if (key == nullptr || key->text() == nullptr) return;
  const std::string& name = *key->text();
  for (const Body& body : system_.bodies())
    if (body.name == name) return;
  if (!is_taken("body", name) && claim(*key, "body") != name) return;
  if (object.find("particle") != nullptr)
    system_.add_particle(name, 1, Vec3::Zero());
  else
    system_.add_body(name, shapes::sphere(1, 1), Pose{});
  errors_.stand_in(name);
}

// Its appearance: colour, and shapes in addition to or instead of those that give its mass.
void Builder::visual(const Params& body, const std::string& name) {
  if (!body.has("visual")) return;
  const Params visual = params_under(body, "visual", "visual");
  out_.looks.push_back(read_look(visual, name));
  if (!visual.boolean("own_shape")) std::erase_if(out_.solids, [&](const Solid& s) { return s.body == name; });
  for_each_object(visual, "shapes", [&](const Value& v, const std::string& owner) {
    keep(name, {read_visual_shape(v, owner, scene_.meshes)}, out_);
  });
}

void Builder::body(const Value& object, const std::string& owner) {
  const Params p = params_of(object, "body", owner, &registry_);
  const std::string name = claim(p.value("name"), "body");
  matter(object, p, name);
  visual(p, name);
}

void Builder::matter(const Value& object, const Params& p, const std::string& name) {
  const std::vector<std::string> kMass = {"mass", "rod", "box", "cylinder", "sphere", "compound", "particle"};
  const bool fixed = p.boolean("fixed");
  if (fixed) refuse_beside(p, "a fixed body never moves", {"velocity", "omega_body", "omega_world"});
  const std::vector<std::string> matter = given(p, kMass);
  const bool bare = matter.empty() || (matter.size() == 1 && matter.front() == "mass" && !p.has("inertia"));
  const std::string kind = fixed && bare ? "" : the_kind(p, kMass);  // the mass of a fixed body is checked if given
  if (kind == "particle" && !fixed)
    refuse_beside(p, "a particle has no rotation and no inertia",
                  {"inertia", "inertia_at", "inertia_axes", "center", "orientation", "omega_body", "omega_world"});
  if (kind == "rod") refuse_beside(p, "\"rod\" defines the pose of the body", {"position", "orientation"});
  Solids solids;
  Shape shape;
  const Pose home{p.vector3("position"), p.orientation("orientation")};
  const double mass = kind == "particle" ? positive(p, "particle", "mass") : 0;
  if (!kind.empty() && kind != "particle") shape = read_matter(p, kind, solids);
  const Pose pose = kind == "rod" ? shape.home : home;
  placed(object.where, [&] {
    if (fixed)
      system_.add_fixed(name, pose);
    else if (kind == "particle")
      system_.add_particle(name, mass, pose.x).start.v = p.vector3("velocity");
    else
      system_.add_body(name, shape.mass, pose).start = read_start(p, pose);
  });
  if (!fixed) read_weight(p, name, out_);
  keep(name, solids, out_);
}

void Builder::marker(const Value& object, const std::string& owner) {
  const Params p = params_of(object, "marker", owner, &registry_);
  const std::string name = claim(p.value("name"), "marker");
  const std::string carrier = p.text("body");
  if (carrier != "ground" && !is_taken("body", carrier))
    p.refuse("body", "unknown body \"" + carrier + "\"" + text::suggestion(carrier, names({"body"})));
  Body& body = system_.body(carrier);
  const bool world = p.has("world_at") || p.has("world_orientation");
  if (world)
    refuse_beside(p, "the pose is already given in world axes (\"world_at\", \"world_orientation\")",
                  {"at", "orientation"});
  const auto pose = [&](const char* at, const char* orientation) {
    return Pose{p.has(at) ? p.vector3(at) : Vec3(Vec3::Zero()),
                p.has(orientation) ? p.orientation(orientation) : Quat{}};
  };
  placed(object.where, [&] {
    Marker& m = world ? system_.add_marker_at(name, body, pose("world_at", "world_orientation"))
                      : system_.add_marker(name, body, pose("at", "orientation"));
    if (p.has("translation")) m.translation_law = p.translation_law("translation");
    if (p.has("rotation")) m.rotation_law = p.rotation_law("rotation");
  });
}

}  // namespace lockstep
