// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/tables.h"

#include <algorithm>
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

// "## table | shelf | help", then its keys: "key | contents | default, or ! if it is required | help". The contents are
// a form, with its unit or its choices, or else the words of Part::holds, with the table of the objects and the
// choices. Several keys of one line differ by their last letters, for which "%" stands in its help. "# group" begins keys
// that "< group" puts into tables.
constexpr const char* kTables = R"_(
## scene | | a mechanism, its start, the settings of the run and the recorded results
lockstep | integer | ! | version of this format: 1
$schema | text | | JSON schema of the format, for editors
title | text | | one line that describes the model
description | text | | further description
parameters | object of quantities | | named numbers and quantities: {"crank": "100 mm", "ratio": 2.5}; formulas such as "=crank*cos(30 deg)" may replace any number, also here
points | object of points | | named points, world: {"A": [0, 0, 0], "B": "=A + [crank, 0, 0]"}; "at", "from", "to" and "position" accept such a name
tables | object of laws | | functions of any argument, for formulas: {"gas": {"type": "spline", "file": "gas.csv", "outside": "hold"}}, read as in "=2*table(gas, crank.rz)", in SI
requires | list of texts | | required plugins, by name without a path
gravity | vector3; acceleration | [0, 0, 0] | acceleration of gravity, world axes
planar | choice; off; auto; x; y; z | "auto" | normal of the plane of motion; a body in the plane has three velocities; "auto": planar if all joints, laws and forces are known to stay in the plane exactly (without the key also: in space if joint coordinates are as few there)
merge | choice; off; auto | "off" | "auto": bodies connected by a fixed joint without a law move as one; joints that are recorded or named by events are kept
include | list of objects; include | | other scenes as parts of this one
repeat | list of objects; repeat | | repeated parts, with an index
set | object of values by path | | new values in included and repeated parts, by path: {"bodies.left_leg.rod.mass": 2}
bodies | list of objects; body | | bodies; the fixed body "ground" always exists
markers | list of objects; marker | | named frames on bodies, for joints and forces
joints | list of objects; link | | joints, couplings and other constraints
links | list of objects; link | | another name of "joints"; a scene with both has one list, in the order of the file
forces | list of objects; force | | applied forces and torques
events | list of objects; event | | changes of the active joints and forces during the run
require | list of conditions | | formulas of parameters and channels that must hold, ["=r > 0 m", {"bearing": "=norm(B.force_on_p_world) < 50 N"}]
run | object; run | | integrator, duration and output
## include | | another scene as a part of this one: its points, bodies, markers, joints, forces and events
scene | text | ! | file of the other scene, relative to the folder of this one
prefix | text | "" | prefix of all its names, such as "left_"
at | vector3; length | [0, 0, 0] | position of its origin, world
orientation | orientation | [1, 0, 0, 0] | orientation of its axes, world; gravity is that of this scene
parameters | object of quantities | | new values of its parameters; formulas here use names of this scene
## repeat | | repeated parts of a scene; in each repetition "{i}" and "{i+1}" in texts become integers, and formulas can use i
times | integer | ! | number of repetitions
index | text | "i" | name of the index
from | integer | 0 | first value of the index
points | object of points | | points, added to those of the scene
bodies | list of objects; body | | bodies, added to those of the scene
markers | list of objects; marker | | markers, added to those of the scene
joints | list of objects; link | | joints, added after those of the scene
links | list of objects; link | | another name of "joints"; a repeat with both has one list, in the order of the file
forces | list of objects; force | | forces, added to those of the scene
# matter
mass | number; mass | | mass; requires "inertia"
inertia | [x, y, z], 3 rows of 3, or object; inertia | | moments of inertia: [Jxx, Jyy, Jzz], {"xx":, ..., "xy":}, or the rows of the matrix; products as matrix entries
inertia_at | [x, y, z] or choice; ; center | | reference point of the inertia, own frame; default: the centre of mass
inertia_axes | orientation | [1, 0, 0, 0] | axes of the inertia, own frame
center | vector3; length | [0, 0, 0] | centre of mass, own frame
rod | object; rod | | a rod; the frame is at mid-length, x along the rod, so "position" and "orientation" are not given
box | object; box | | a box, centred at the origin of its frame
cylinder | object; cylinder | | a cylinder, centred at the origin of its frame, along z
sphere | object; sphere | | a sphere, centred at the origin of its frame
## body | | a rigid body, a particle or a fixed frame; one of "mass", "rod", "box", "cylinder", "sphere", "compound", "particle" and "fixed" is required
name | text | ! | name, unique in the scene
< matter
compound | list of objects; part | | rigidly connected parts, each placed in the body frame
particle | number; mass | | mass of a particle; it has no rotation
fixed | boolean | false | true: the body does not move and needs no mass
position | vector3; length | [0, 0, 0] | origin of the body frame at the start, world
orientation | orientation | [1, 0, 0, 0] | orientation of the body frame at the start, world
velocity | vector3; speed | [0, 0, 0] | velocity of the frame's origin at the start, world axes
omega_body | vector3; angular speed | | angular velocity at the start, body axes
omega_world | vector3; angular speed | | angular velocity at the start, world axes
assembled | choice; approximate; exact; free | "approximate" | change of the start pose by assembly: as small as possible, none, or free
start_weight | number | 1 | weight of the start pose in assembly, relative to other bodies
visual | object; visual | | appearance in reports
## part | | an object of "compound": a part of a body; one of "mass", "rod", "box", "cylinder" and "sphere" is required
< matter
position | vector3; length | [0, 0, 0] | origin of the part's frame, body frame
orientation | orientation | [1, 0, 0, 0] | orientation of the part's frame, body frame
## inertia | | inertia matrix by its entries; products as matrix entries, J_xy = -integral of x y dm
xx yy zz | number; moment of inertia | ! | entry of the inertia matrix
xy yz zx | number; moment of inertia | 0 | entry of the inertia matrix
## visual | | appearance of a body in reports
color | text | | "#rrggbb"; default: the next colour of a palette
opacity | number | 1 | from 0 (transparent) to 1 (opaque)
own_shape | boolean | true | true: the shape that defines the mass is also drawn
shapes | list of objects; visual_shape | | further shapes and meshes, without mass
## visual_shape | | an object of "shapes": a shape or mesh for drawing, without mass
rod | object; rod | | a rod between two points, body frame
box | object; box | | a box, centred at the origin of its frame
cylinder | object; cylinder | | a cylinder, centred at the origin of its frame, along z
sphere | object; sphere | | a sphere, centred at the origin of its frame
mesh | text | | mesh file, STL or OBJ, relative to the folder of the scene
scale | number | 1 | scale factor of the mesh: 0.001 for millimetres; a negative factor mirrors it
at | vector3; length | [0, 0, 0] | origin of the shape's frame, body frame
orientation | orientation | [1, 0, 0, 0] | orientation of the shape's frame, body frame
## marker | | a frame on a body, fixed to it or moved by laws
name | text | ! | name, unique in the scene
body | text | ! | body of the marker
at | vector3; length | | origin, body frame
orientation | orientation | | orientation, body frame
world_at | vector3; length | | origin at the start, world
world_orientation | orientation | | orientation at the start, world
translation | translation law; length | | translation along the axes of its reference configuration
rotation | rotation law; angle | | rotation about the axes of its reference configuration
# attachment
p | text | | marker P, or the body on which a new marker P is placed
s | text | | marker S, from which P is measured, or the body on which a new marker S is placed
at | vector3; length | | position of both new markers at the start, world
at_p | vector3; length | | position of the new marker P at the start, world
at_s | vector3; length | | position of the new marker S at the start, world
axis | axis | | z axis of the new markers at the start, world; their x axis is as close as possible to x of the world, or to y if z is along x
orientation | orientation | | orientation of the new markers at the start, world
## link | links | an object of "joints": a joint, a coupling or another constraint; in channels, "_link_" means the axes of marker S
name | text | ! | name, unique in the scene
type | text | ! | type, see `lockstep list joints`
< attachment
pairs | list of names or objects; pair | | for couplings, instead of p and s: names of the coupled joints, or {"p":, "s":, ...} each
drive | object or list of objects; drive | | prescribed motions of free coordinates (motors)
move | translation law; length | | prescribed position of P, S axes, for the constraints x y z
turn | rotation law; angle | | prescribed rotation of P relative to S
active | boolean | true | true: active from the start
hold | boolean | false | true: when activated, the joint locks its constrained coordinates at their present values
start | object; start | | initial conditions of the free coordinates
unilateral | object; unilateral | | makes a joint of one constraint one-sided: it pushes but does not pull, so that its markers can separate
stops | list of objects; travel | | limits of the free coordinates; each is a one-sided joint named "A.stop_rz_low", ...
friction | object; friction | | friction caused by the joint's own reaction; a force named "A.friction"
## pair | | an object of "pairs": two markers whose relative motion is coupled
< attachment
## force | forces | an applied force or torque; it does not constrain motion
name | text | ! | name, unique in the scene
type | text | ! | type, see `lockstep list forces`
< attachment
link | text | | joint in which it acts, instead of p and s (joint_friction, function_force)
active | boolean | true | true: active from the start
## rod | | a straight rod; its frame is at mid-length, x along the rod
mass | number; mass | | mass, or "density"
density | number; density | | density, or "mass"
from | vector3; length | ! | one end (of a body: world; of a part: body frame)
to | vector3; length | ! | the other end
roll | number; angle | 0 | rotation of the frame about the rod; at 0, z is as near to the world z axis as possible
radius | number; length | | radius of the solid cylinder; default: length / 50
axial_inertia | number; moment of inertia | | moment of inertia about the axis, for a rod without thickness
## box | | a solid box
mass | number; mass | | mass, or "density"
density | number; density | | density, or "mass"
size | vector3; length | ! | edge lengths
## cylinder | | a solid cylinder along z
mass | number; mass | | mass, or "density"
density | number; density | | density, or "mass"
radius | number; length | ! | radius
length | number; length | ! | length
## sphere | | a solid sphere
mass | number; mass | | mass, or "density"
density | number; density | | density, or "mass"
radius | number; length | ! | radius
## drive | | an ideal motor: it prescribes the motion of one free coordinate of a joint by one constraint
axis | choice; x; y; z; rx; ry; rz | ! | coordinate of P relative to S
law | law; quantity | | coordinate as a function of time, m or rad; required, or "speed"
speed | law; quantity | | rate as a function of time, m/s or rad/s; its integral is the coordinate; required, or "law"
## start | | initial conditions of the free coordinates of a joint
velocity | object; start_velocity | | rates
position | object; start_position | | values, met exactly
near | object; start_position | | values, met as nearly as the other conditions allow
## start_velocity | | velocity of P relative to S at the start, S axes
x y z | number; speed | | along % of S
rx ry rz | number; angular speed | | about % of S
## start_position | | coordinates of P relative to S at the start, S axes
x y z | number; length | | along % of S
rx ry rz | number; angle | | about % of S
## unilateral | | the free side of a one-sided joint, and its impacts
restitution | number | 0 | ratio of the speed after an impact to the speed before, from 0 to 1
rest_speed | number; quantity | 0.001 | an impact with a lower rebound speed ends at rest, m/s or rad/s
side | choice; above; below | "above" | free side: a value above the one that the joint holds, as for a floor, or below it, as for a rope
## travel | | an object of "stops": limits of one coordinate of a joint
axis | choice; x; y; z; rx; ry; rz | ! | coordinate of P relative to S
low | number; quantity | | lower limit, m or rad; required, or "high", or both
high | number; quantity | | upper limit, m or rad; required, or "low", or both
restitution | number | 0 | ratio of the speed after an impact to the speed before, from 0 to 1
rest_speed | number; quantity | 0.001 | an impact with a lower rebound speed ends at rest, m/s or rad/s
## friction | | dry and viscous friction from the present reaction of a revolute, prismatic, cylindrical, point_on_line, point_on_plane, plane_on_plane, oldham or lock; other joints have none
< friction
## event | | a change of the active joints and forces between two steps
name | text | ! | name, unique among events
at | number; time | | time of the event, or "when"
when | object; condition | | condition of the event, or "at"
activate | list of texts | | joints and forces to activate
deactivate | list of texts | | joints and forces to deactivate
stop | boolean | false | true: the run ends at the event
once | boolean | true | true: the event occurs only the first time that the condition is met
## condition | | "when" of an event: a channel that crosses a value
channel | text | ! | channel, column or formula, such as "slider.x"
crosses | number; quantity | 0 | value of the channel at the event
direction | choice; any; rising; falling | "any" | direction of the crossing
## run | | numerical method and output
integrator | name or object; integrators | | a name of `lockstep list integrators`, or {"type": name, and its keys}; default "dopri5"
step | number; time | | fixed step, or the largest step of an adaptive integrator
tolerance | number | 1e-06 | relative tolerance of adaptive integrators; the absolute tolerance is a hundredth of it, m or rad
until | number; time | | end of the run; 0: the start alone, one row
output | number; time | | interval of the recorded times; default: every step
times | numbers; time | | recorded times, rising; instead of "output"
energy_limit | number | 0.001 | limit of the energy error, relative to the energy exchanged; beyond it the result is wrong (exit code 9)
violation_limit | number; length | | limit of the constraint violation; beyond it the result is wrong (exit code 9); default: 0.001 of the mechanism's size
max_steps | integer | | limit of the number of steps; the run then ends with an error
formulation | choice; omega; quaternion; joint; auto | "auto" | unknowns: joint coordinates, 6 velocities per body (omega), or 7 coordinates per body (quaternion); auto: joint coordinates if they cost less and no solver is named, else omega
stabilization | choice, or object; stabilization; project; baumgarte; none | | correction of the constraint violation (drift); default "project"
solver | name or object; solvers | | a name of `lockstep list solvers`, or {"type": name, and its keys}; default "schur", with formulation quaternion "sparse"
nearly_redundant | choice; auto; report; free; held | "auto" | treatment of nearly dependent constraints (relative singular value below 1e-3), such as two nearly coaxial hinges: kept (held), removed (free), or only reported (report); auto: removed, but kept if joints would open; reported beyond 300 constraints
assemble | boolean | true | true: a start that violates the constraints is corrected
record | list of channel names: see `lockstep check SCENE --channels` | | recorded channels, by name or as {"own name": "channel"}
draw | list of lists of texts | | panels of the picture from top to bottom, each a list of recorded names or formulas; default: by unit
pictures | list of objects; picture | | further pictures, each of one column against another
headers | choice; units; plain | "units" | column names of the CSV file: with units, "x [m]", or plain, "x"
at_jumps | boolean | false | true: also rows just before and after events, impacts and jumps of laws
## picture | | a plot of one column against another, such as the path of a point; lengths have equal scales
x | text | ! | column of the x axis, by its recorded name, or a formula; "t" is the time
y | text | ! | column of the y axis
## stabilization | | correction of the constraint violation (drift)
kind | choice; project; baumgarte; none | "project" | method
alpha | number | 5 | damping rate of Baumgarte stabilisation, 1/s
beta | number | 5 | stiffness rate of Baumgarte stabilisation, 1/s
tolerance | number; length | 1e-10 | tolerance of the constraint violation)_";

// The value of an enumeration that ends with `last` by its name; `last` for another name.
template <class E>
E by_name(const std::string& name, E last) {
  int k = 0;
  while (k < static_cast<int>(last) && name_of(static_cast<E>(k)) != name) ++k;
  return static_cast<E>(k);
}

void add_key(SceneTable& to, const std::string& name, const std::vector<std::string>& columns) {
  std::vector<std::string> holds = words_at(';', columns[1]);
  holds.resize(std::max<std::size_t>(2, holds.size()));
  Key key{name, by_name(holds[0], Form::any), Unit::none, kOptional, columns[3]};
  std::ranges::replace(key.help, '%', name.back());
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
      for (const std::string& name : lines_of(columns[0], ' ')) add_key(*to, name, columns);
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
