// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/tables.h"

#include <cassert>
#include <map>

#include <lockstep/forces.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/tree.h"
#include "framework/foundation/support/lines.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

// "## table | shelf | help", then its keys: "key | what it holds | default, or ! where it must be given | help". A key
// holds a form, with its unit or its choices, or else what Part::holds says, with the table of the objects and the
// choices. "# group" begins keys that "< group" puts into tables.
constexpr const char* kTables = R"_(
## scene | | a mechanism, how it starts, how it runs and what is recorded
lockstep | integer | ! | version of this format: 1
$schema | text | | the JSON schema, for editors
title | text | | one line that says what moves
description | text | | more about it
parameters | object of quantities | | numbers and quantities by name: {"crank": "100 mm", "ratio": 2.5}; "=crank*cos(30 deg)" stands wherever a number does, here too
points | object of points | | points by name, world: {"A": [0, 0, 0], "B": "=A + [crank, 0, 0]"}; "at", "from", "to", "position" of bodies, markers and links take a name
requires | list of texts | | plugins that must be loaded, by bare name; no path
gravity | vector3; acceleration | [0, 0, 0] | gravity, world axes
planar | choice; off; auto; x; y; z | "auto" | normal of the plane of all motion: three velocities per body; "auto": where that is exact and all links, laws and forces are known to stay in it (without the key, only where joint coordinates do not serve)
merge | choice; off; auto | "off" | "auto": bodies joined by a fixed link without a law move as one; links that are recorded, or that events name, stay
include | list of objects; include | | other scenes as parts of this one
repeat | list of objects; repeat | | parts of the scene several times, with an index
set | object of values by path | | other values of what included and repeated parts bring, by path: {"bodies.left_leg.rod.mass": 2}
bodies | list of objects; body | | the bodies; "ground" always exists
markers | list of objects; marker | | frames on bodies that links and forces name
links | list of objects; link | | what holds the bodies together
forces | list of objects; force | | the forces applied to them
events | list of objects; event | | changes of the links in force during the run
run | object; run | | integrator, duration, output
## include | | another scene as a part of this one: its points, bodies, markers, links, forces and events
scene | text | ! | its file, from the folder of this scene
prefix | text | "" | put before its names, as in "left_"
at | vector3; length | [0, 0, 0] | where its origin is put, world
orientation | orientation | [1, 0, 0, 0] | how its axes are turned, in the world; gravity is this scene's
parameters | object of quantities | | other values of its parameters; formulas are of this scene's
## repeat | | parts of a scene, several times; "{i}" and "{i+1}" in texts become whole numbers, i in formulas is one
times | integer | ! | how many times
index | text | "i" | name of the index
from | integer | 0 | its first value
points | object of points | | added to those of the scene
bodies | list of objects; body | | likewise
markers | list of objects; marker | | likewise
links | list of objects; link | | likewise, behind those of the scene
forces | list of objects; force | | likewise
# matter
mass | number; mass | | mass, given with "inertia"
inertia | [x, y, z], 3 rows of 3, or object; inertia | | [Jxx, Jyy, Jzz], {"xx":, ..., "xy":}, or three rows; products as matrix entries
inertia_at | [x, y, z] or choice; ; center | | point about which the inertia is given, own frame
inertia_axes | orientation | [1, 0, 0, 0] | axes of the inertia, in its own frame
center | vector3; length | [0, 0, 0] | mass centre, own frame
rod | object; rod | | a rod; it defines the frame: in its middle, x along it
box | object; box | | a box about its frame's origin
cylinder | object; cylinder | | a cylinder about its frame's origin, along z
sphere | object; sphere | | a sphere about its frame's origin
## body | | a rigid body, a particle or a fixed frame
name | text | ! | its name, unique in the scene
< matter
compound | list of objects; part | | several parts, rigidly joined, each placed in the body's frame
particle | number; mass | | mass of a particle, which has no rotation
fixed | boolean | false | it never moves and needs no mass
position | vector3; length | [0, 0, 0] | origin of its frame at the start, world
orientation | orientation | [1, 0, 0, 0] | its axes at the start, in the world
velocity | vector3; speed | [0, 0, 0] | of the frame's origin at the start, world axes
omega_body | vector3; angular speed | | angular velocity at the start, body axes
omega_world | vector3; angular speed | | angular velocity at the start, world axes
assembled | choice; approximate; exact; free | "approximate" | what assembling the start may do to its pose: as little as the rest allows, nothing, or anything
start_weight | number | 1 | how much its start pose counts against those of others
visual | object; visual | | what it looks like in reports
## part | | a part of a compound body
< matter
position | vector3; length | [0, 0, 0] | origin of the part's frame, body frame
orientation | orientation | [1, 0, 0, 0] | axes of the part, in the body frame
## inertia | | an inertia matrix by its entries; products as matrix entries, J_xy = -integral of x y dm
xx | number; moment of inertia | ! | entry of the inertia matrix
yy | number; moment of inertia | ! | entry of the inertia matrix
zz | number; moment of inertia | ! | entry of the inertia matrix
xy | number; moment of inertia | 0 | entry of the inertia matrix
yz | number; moment of inertia | 0 | entry of the inertia matrix
zx | number; moment of inertia | 0 | entry of the inertia matrix
## visual | | what a body looks like in reports, beside its shape
color | text | | "#rrggbb"; default: the next of a palette
opacity | number | 1 | from 0, glass, to 1, solid
own_shape | boolean | true | whether the shape that gives its mass is drawn, too
shapes | list of objects; visual_shape | | further shapes and meshes, without mass
## visual_shape | | a shape that is drawn and weighs nothing
rod | object; rod | | a rod from one point to another, body frame
box | object; box | | a box about its frame's origin
cylinder | object; cylinder | | a cylinder about its frame's origin, along z
sphere | object; sphere | | a sphere about its frame's origin
mesh | text | | file of a mesh, STL or OBJ; path from the scene's folder
scale | number | 1 | factor on the mesh's points: 0.001 of one in mm; below 0: mirrored
at | vector3; length | [0, 0, 0] | origin of its frame, body frame
orientation | orientation | [1, 0, 0, 0] | its axes, in the body frame
## marker | | a frame on a body, fixed there or moved by laws
name | text | ! | its name, unique in the scene
body | text | ! | the body that carries it
at | vector3; length | | its origin, body frame
orientation | orientation | | its axes, in the body frame
world_at | vector3; length | | its origin at the start, world
world_orientation | orientation | | its axes at the start, in the world
translation | translation law; length | | moves it along its own home axes
rotation | rotation law; angle | | turns it about them
# attachment
p | text | | the marker P, or a body that is given one
s | text | | the marker S that P is seen from, or a body that is given one
at | vector3; length | | where both new markers are at the start, world
at_p | vector3; length | | where the new marker P is at the start, world
at_s | vector3; length | | where the new marker S is at the start, world
axis | axis | | z axis of the new markers at the start, world
orientation | orientation | | axes of the new markers at the start, in the world
## link | links | a joint, a lock or any other constraint between bodies
name | text | ! | its name, unique in the scene
type | text | ! | what it is: see `lockstep list links`
< attachment
pairs | list of names or objects; pair | | in place of p and s: links whose markers it couples, by name, or {"p":, "s":, ...} each
drive | object or list of objects; drive | | laws on coordinates that the link leaves free
move | translation law; length | | where P is held, S axes, on the rows x y z
turn | rotation law; angle | | how far P is held turned against S
active | boolean | true | whether it holds from the start
hold | boolean | false | whether it closes where its bodies stand: what its mask holds then is P as it stands against S at that instant
start | object; start | | how its free coordinates begin
unilateral | object; unilateral | | its one row may push but not pull: C >= 0 instead of C = 0
stops | list of objects; travel | | ends of the travel of its free coordinates; links named "A.stop_rz_low", ...
friction | object; friction | | friction from its own reaction; a force named "A.friction"
## pair | | two markers whose relative motion is coupled
< attachment
## force | forces | an applied force: it pushes or pulls, but does not hold
name | text | ! | its name, unique in the scene
type | text | ! | what it is: see `lockstep list forces`
< attachment
link | text | | the link in which it acts, for friction
active | boolean | true | whether it acts from the start
## rod | | a straight rod, its frame in the middle with x along it
mass | number; mass | | mass; or "density"
density | number; density | | mass by volume; or "mass"
from | vector3; length | ! | one end (of a body: world; of a part: body frame)
to | vector3; length | ! | the other end
roll | number; angle | 0 | turns its frame about its axis, from z as near to the world's as can be
radius | number; length | | of a solid cylinder; default: length / 50
axial_inertia | number; moment of inertia | | a rod without thickness, with this inertia about its axis
## box | | a solid box
mass | number; mass | | mass; or "density"
density | number; density | | mass by volume; or "mass"
size | vector3; length | ! | its three edges
## cylinder | | a solid cylinder along z
mass | number; mass | | mass; or "density"
density | number; density | | mass by volume; or "mass"
radius | number; length | ! | its radius
length | number; length | ! | its length
## sphere | | a solid sphere
mass | number; mass | | mass; or "density"
density | number; density | | mass by volume; or "mass"
radius | number; length | ! | its radius
## drive | | a law on one free coordinate of a link; adds exactly one row
axis | choice; x; y; z; rx; ry; rz | ! | the coordinate of P seen from S
law | law; quantity | | the coordinate as a function of time, m or rad
speed | law; quantity | | its speed as a function of time, m/s or rad/s; the coordinate is integrated
## start | | how the free coordinates of a link begin
velocity | object; start_velocity | | their speeds
position | object; start_position | | their values, exactly
near | object; start_position | | their values, as near as all else that is asked for allows
## start_velocity | | speeds of P against S at the start, S axes
x | number; speed | | along x of S
y | number; speed | | along y of S
z | number; speed | | along z of S
rx | number; angular speed | | about x of S
ry | number; angular speed | | about y of S
rz | number; angular speed | | about z of S
## start_position | | coordinates of P against S at the start, S axes
x | number; length | | along x of S
y | number; length | | along y of S
z | number; length | | along z of S
rx | number; angle | | about x of S
ry | number; angle | | about y of S
rz | number; angle | | about z of S
## unilateral | | impacts of a link that may push but not pull
restitution | number | 0 | ratio of the speed after an impact to that before, 0 to 1
rest_speed | number; quantity | 0.001 | impacts that leave less end at rest, m/s or rad/s
side | choice; above; below | "above" | where its row is free: C >= 0, or C <= 0 as for a rope
## travel | | where the travel of one coordinate of a link ends
axis | choice; x; y; z; rx; ry; rz | ! | the coordinate of P seen from S
low | number; quantity | | its lowest value, m or rad
high | number; quantity | | its highest value, m or rad
restitution | number | 0 | ratio of the speed after an impact to that before, 0 to 1
rest_speed | number; quantity | 0.001 | impacts that leave less end at rest, m/s or rad/s
## friction | | dry and viscous friction in a link, from its present reaction
< friction
## event | | a change of the links and forces that act, between two steps
name | text | ! | its name, unique among events
at | number; time | | the instant; or "when"
when | object; condition | | the condition; or "at"
activate | list of texts | | links and forces that begin to act
deactivate | list of texts | | links and forces that stop acting
stop | boolean | false | whether the run ends there
once | boolean | true | only the first time that the condition is met
## condition | | a channel that crosses a value
channel | text | ! | a channel's name, such as "slider.x"
crosses | number; quantity | 0 | the value
direction | choice; any; rising; falling | "any" | the direction of crossing
## run | | how the motion is computed and what is written
integrator | name or object; integrators | | a name of `lockstep list integrators`, or {"type": name, and its keys}; default "dopri5"
step | number; time | | fixed step, or the largest step of an adaptive integrator
tolerance | number | 1e-06 | relative tolerance of adaptive integrators; absolute: a hundredth of it, m
until | number; time | | end of the run; 0: its start alone, one row
output | number; time | | interval of the recorded instants; default: every step
times | numbers; time | | or these instants, rising
energy_limit | number | 0.001 | an energy balance off by more, relative to the energy exchanged, is an error of the run
violation_limit | number; length | | a larger violation of the constraints is an error of the run; default: a thousandth of the mechanism's size
max_steps | integer | | the run ends with an error after so many steps
formulation | choice; omega; quaternion; joint; auto | "auto" | unknowns: 6 velocities per body, the paper's 7 coordinates, or the coordinates of the joints; auto: of the joints where that costs less and no solver is named, else omega
stabilization | choice, or object; stabilization; project; baumgarte; none | | how drift off the constraints is corrected; default "project"
solver | name or object; solvers | | a name of `lockstep list solvers`, or {"type": name, and its keys}; default "schur", with formulation quaternion "sparse"
nearly_redundant | choice; auto; told; free; held | "auto" | rows that depend on others but for a singular value below 1e-3, as of two hinges whose axes nearly agree: held, left out (free), or told and not decided; auto: held as they are written, and told where that cannot be
assemble | boolean | true | a start off the constraints is moved onto them
record | list of channel names: see `lockstep check SCENE --channels` | | the channels, by name or as {"own name": "channel"}
draw | list of lists of texts | | panels of the picture from top to bottom, each a list of recorded names; default: by unit
pictures | list of objects; picture | | more pictures, each of one recorded column against another
headers | choice; units; plain | "units" | names of the columns in the CSV file, with their units, "x [m]", or plain, "x"
at_jumps | boolean | false | rows also just before and just after events, impacts and jumps of laws
## picture | | a picture of one column against another, as the path of a point; lengths have equal scales
x | text | ! | the column of the x axis, by its recorded name; "t": the time
y | text | ! | the column of the y axis
## stabilization | | how drift off the constraints is corrected
kind | choice; project; baumgarte; none | "project" | the method
alpha | number; frequency | 5 | Baumgarte's damping rate, 1/s
beta | number; frequency | 5 | Baumgarte's stiffness rate, 1/s
tolerance | number; length | 1e-10 | of the constraints, m
)_";

// The value of an enumeration that ends with `last` by its name; `last` for another name.
template <class E>
E by_name(const std::string& name, E last) {
  int k = 0;
  while (k < static_cast<int>(last) && name_of(static_cast<E>(k)) != name) ++k;
  return static_cast<E>(k);
}

void add_key(SceneTable& to, const std::vector<std::string>& columns) {
  std::vector<std::string> holds = words_at(';', columns[1]);
  holds.resize(std::max<std::size_t>(2, holds.size()));
  Key key{columns[0], by_name(holds[0], Form::any), Unit::none, kOptional, columns[3]};
  if (const std::string& fallback = columns[2]; fallback == "!")
    key.fallback = kRequired;
  else if (!fallback.empty())
    key.fallback = placed_at({}, read_json(fallback, ""));
  if (key.form == Form::any) to.parts.push_back({key.name, holds[0], holds[1]});
  if (key.form == Form::choice || key.form == Form::any)
    key.choices.assign(holds.begin() + (key.form == Form::any ? 2 : 1), holds.end());
  else if (!holds[1].empty())
    key.unit = by_name(holds[1], Unit::any);
  if (key.unit == Unit::any && name_of(key.unit) != holds[1])
    throw ModelError("key \"" + key.name + "\" of the scene's tables: unknown unit \"" + holds[1] + "\"");
  to.info.keys.push_back(std::move(key));
}

std::vector<SceneTable> all_tables() {
  std::map<std::string, SceneTable> groups = {{"friction", {JointFriction::info()}}};
  std::vector<SceneTable> all;
  SceneTable* to = nullptr;
  for (const std::string& line : lines_of(kTables)) {
    const std::vector<std::string> columns = words_at('|', line);
    if (line.starts_with("## ")) {
      all.push_back({{columns[0].substr(3), columns[2], {}}, {}, columns[1]});
      to = &all.back();
    } else if (line.starts_with("# ")) {
      to = &groups[line.substr(2)];
    } else if (line.starts_with("< ")) {
      const SceneTable& group = groups.at(line.substr(2));
      to->info.keys.insert(to->info.keys.end(), group.info.keys.begin(), group.info.keys.end());
      to->parts.insert(to->parts.end(), group.parts.begin(), group.parts.end());
    } else if (!line.empty()) {
      add_key(*to, columns);
    }
  }
  for (const SceneTable& table : all) check_type_info(table.info);
  return all;
}

}  // namespace

const std::vector<SceneTable>& scene_tables() {
  static const std::vector<SceneTable> kAll = all_tables();
  return kAll;
}

const SceneTable& scene_table(const std::string& name) {
  for (const SceneTable& table : scene_tables())
    if (table.info.name == name) return table;
  assert(false && "no such table of the scene");
  return scene_tables().front();
}

}  // namespace lockstep
