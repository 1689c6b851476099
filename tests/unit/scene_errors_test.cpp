// SPDX-License-Identifier: BSD-3-Clause
// Every kind of bad scene: refused at its place, with the name of the thing, the value and the next move.
#include <fstream>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/sweep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/refused_scene.h"

namespace scene_errors_test {

using namespace lockstep;
using lockstep::testing::refusal_of;

namespace {

// The second line of a scene, "~" before the place that the message must name; and words that must be in the message.
struct Bad {
  std::string line;
  std::vector<std::string> words;
};

#define TWO_BODIES \
  R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}, {"name": "bob", "particle": 2}], )"
#define ONE_LINK R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0]}], )"
#define COUPLED \
  R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}, {"name": "leg", "rod": {"mass": 1, "from": [1,0,0], "to": [2,0,0]}}], "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0]}, {"name": "B", "type": "revolute", "p": "leg", "s": "arm", "at": [1,0,0]}, {"name": "G", "type": "gear", "pairs": ["A", "B"], "ratio": 2)"

const std::vector<Bad> kBodies = {
    {R"("bodies": [{"name": "a", "particle": 1, ~"colour": 3}])", {"body 'a'", "unknown key \"colour\""}},
    {R"("bodies": [{"name": "a", ~"partikle": 1}])", {"body 'a'", "did you mean \"particle\""}},
    {R"("bodies": [{"name": "a", "particle": 1, ~"particle": 2}])", {"\"particle\"", "twice", "remove one"}},
    {R"("bodies": [{"name": "a", "particle": ~-1}])", {"body 'a'", "-1", "greater than 0"}},
    {R"("bodies": [{"name": "a", "particle": ~0}])", {"body 'a'", "mass is 0"}},
    {R"("bodies": [{"name": "a", "particle": ~"3 mm"}])", {"body 'a', particle", "a length", "a mass"}},
    {R"("bodies": [{"name": "a", "particle": ~"3 kgg"}])", {"body 'a', particle", "unknown unit \"kgg\""}},
    {R"("bodies": [{"name": "a", "particle": ~true}])", {"body 'a', particle", "true"}},
    {R"("bodies": [{"name": "a", "particle": ~NaN}])", {"NaN"}},
    {R"("bodies": [{"name": "a", "particle": ~1e999}])", {"1e999", "range"}},
    {R"("bodies": [{"name": "a", "mass": ~1}])", {"body 'a', mass", "inertia"}},
    {R"("bodies": [{"name": "a", "mass": 1, "inertia": ~[1, 1, -1]}])", {"body 'a'", "positive"}},
    {R"("bodies": [{"name": "a", "mass": 1, "inertia": ~[1, 1, 3]}])", {"body 'a'", "triangle"}},
    {R"("bodies": [{"name": "a", "mass": 1, "inertia": ~[1, 1]}])", {"body 'a', inertia", "list of 2"}},
    {R"("bodies": [{"name": "a", "mass": 1, "inertia": [1, 1, 1], "inertia_at": ~"origin"}])",
     {"inertia_at", "center"}},
    {R"("bodies": [{"name": "a", "particle": 1, "position": ~[0, 0]}])", {"body 'a', position", "list of 3"}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "orientation": ~[0, 0, 0, 0]}])", {"quaternion"}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "orientation": {"axis": ~[0, 0, 0], "angle": 1}}])",
     {"axis", "direction"}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": ~0}}])", {"body 'a', sphere", "radius is 0"}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "density": ~2, "radius": 1}}])", {"either", "not both"}},
    {R"("bodies": [{"name": "a", "box": {"mass": 1, "size": ~[1, 0, 1]}}])", {"body 'a', box.size", "greater than 0"}},
    {R"("bodies": [{"name": "a", "rod": {"mass": 1, "from": [0,0,0], "to": ~[0,0,0]}}])",
     {"body 'a', rod.to", "same point"}},
    {R"("bodies": [{"name": "a", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}, "position": ~[0,0,0]}])",
     {"remove \"position\""}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "particle": ~1}])",
     {"\"sphere\" and \"particle\"", "remove one"}},
    {R"("bodies": [~{"name": "a"}])", {"body 'a': it has no mass"}},
    {R"("bodies": [~{"particle": 1}])", {"bodies[0]", "missing key \"name\""}},
    {R"("bodies": [{"name": "a", "particle": 1}, {"name": ~"a", "particle": 1}])",
     {"body 'a'", "taken", "bad.json:2:"}},
    {R"("bodies": [{"name": ~"ground", "particle": 1}])", {"body 'ground'", "choose another"}},
    {R"("bodies": [{"name": ~"a.b", "particle": 1}])", {"body 'a.b'", "channels"}},
    {R"("bodies": ~{"name": "a"})", {"bodies", "list of objects"}},
    {R"("bodies": [~3])", {"bodies[0]", "number"}},
    {R"("bodies": [{"name": "a", "sphere": ~{"radius": 1}}])", {"body 'a', sphere.mass", "neither is given"}},
    {R"("bodies": [{"name": "a", "mass": 1, "inertia": ~[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]}])",
     {"not symmetric", "entry 21 is 0 and entry 12 is 0.1"}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "orientation": ~{"sequence": "xyz"}}])",
     {"\"sequence\" needs \"angles\""}},
    {R"("bodies": [{"name": "a", "compound": [{"box": {"mass": 1, "size": [1,1,1]}, ~"place": [0,0,0]}]}])",
     {"compound[0]", "unknown key"}},
    {R"("bodies": [{"name": "a", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0], "axial_inertia": 1, "radius": ~0.1}}])",
     {"body 'a', rod", "\"axial_inertia\" makes a rod without thickness", "remove \"radius\""}},
    {R"("bodies": [{"name": "a", "mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1, "xz": ~0.1}}])",
     {"body 'a', inertia", "unknown key \"xz\"", "its entry is \"zx\""}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "inertia": ~[1, 1, 1]}])",
     {"\"sphere\" defines mass and inertia", "remove \"inertia\""}},
    {R"("bodies": [{"name": "a", "compound": [{"sphere": {"mass": 1, "radius": 1}}], "center": ~[0, 0, 0]}])",
     {"\"compound\" defines mass and inertia", "remove \"center\""}},
    {R"("bodies": [{"name": "a", "compound": ~[]}])", {"body 'a', compound", "the list is empty", "at least one part"}},
    {R"("bodies": [{"name": "a", "compound": [{"rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}, "position": ~[0,0,0]}]}])",
     {"\"rod\" defines the pose of the part", "remove \"position\""}},
    {R"("bodies": [{"name": "a", "fixed": true, "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}, "position": ~[0,0,0]}])",
     {"\"rod\" defines the pose of the body", "remove \"position\""}},
    {R"("bodies": [{"name": "a", "fixed": true, "velocity": ~[1,0,0]}])",
     {"a fixed body never moves", "remove \"velocity\""}},
    {R"("bodies": [{"name": "a", "particle": 1, "omega_body": ~[1,0,0]}])",
     {"a particle has no rotation", "remove \"omega_body\""}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "omega_body": [1,0,0], "omega_world": ~[1,0,0]}])",
     {"body 'a', omega_world", "\"omega_body\" is given as well", "remove one"}},
    {R"("bodies": [{"name": ~"", "particle": 1}])", {"the name is empty", "give it one"}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "visual": {"color": ~"red"}}])",
     {"body 'a', visual.color", "\"red\" is not a colour", "#0072b2"}},
    {R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 1}, "visual": {"opacity": ~2}}])",
     {"body 'a', visual.opacity", "it is 2", "from 0 to 1"}},
    {R"("parameters": {"a": 1}, "points": {"P": [1, ~"2 kg", 3]})", {"different dimensions", "the same unit"}},
    {R"("points": {"P": "=m.from"}, "bodies": [{"name": "a", "particle": 1}], "markers": [~{"name": "m", "body": "a", "at": [0,0,0]}])",
     {"marker 'm'", "it has no \".from\"", "\".at\""}},
};

const std::vector<Bad> kLinks = {
    {TWO_BODIES R"("links": [{"name": "A", "type": ~"revolut", "p": "arm", "s": "ground", "at": [0,0,0]}])",
     {"joint 'A'", "did you mean \"revolute\""}},
    {TWO_BODIES R"("links": [{"name": "A", "type": "revolute", "p": ~"amr", "s": "ground", "at": [0,0,0]}])",
     {"joint 'A', p", "did you mean \"arm\""}},
    {TWO_BODIES R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": ~"arm", "at": [0,0,0]}])",
     {"joint 'A', s", "'arm'", "both sides are on body"}},
    {TWO_BODIES R"("links": [{"name": "A", "type": "revolute", "p": ~"arm", "s": "ground"}])",
     {"joint 'A', p", "add \"at\""}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "axis": ~[0,0,0]}])",
     {"joint 'A', axis", "direction"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], ~"mask": "x"}])",
     {"joint 'A'", "unknown key \"mask\""}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": "rz", "law": {"type": "ramp", ~"slop": 2}}}])",
     {"joint 'A', drive.law", "did you mean \"slope\""}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": "rz", "law": {"type": ~"rampe"}}}])",
     {"joint 'A', drive.law", "did you mean \"ramp\""}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": ~"x", "law": 1}}])",
     {"'A'", "x"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": ~"rw", "law": 1}}])",
     {"joint 'A', drive.axis", "rw"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": ~{"axis": "rz"}}])",
     {"joint 'A', drive: the drive has no motion"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "start": {"velocity": {"x": ~1}}}])",
     {"name a free one"}},
    {TWO_BODIES R"("links": [{"name": ~"A", "type": "revolute", "p": "bob", "s": "ground"}])",
     {"joint 'A'", "'bob'", "particle"}},
    {TWO_BODIES R"("links": [{"name": "A", "type": "lock", "mask": ~"x q", "p": "arm", "s": "ground", "at": [0,0,0]}])",
     {"q"}},
    {TWO_BODIES ONE_LINK R"("markers": [{"name": "m", "body": ~"arn"}])", {"marker 'm', body", "did you mean \"arm\""}},
    {TWO_BODIES R"("markers": [{"name": "m", "body": "arm", "at": ~[0,0,0], "world_at": [1,0,0]}])",
     {"marker 'm', at", "remove"}},
    {TWO_BODIES R"("markers": [{"name": ~"arm", "body": "arm"}])", {"marker 'arm'", "taken by body 'arm'"}},
    {TWO_BODIES R"("forces": [{"name": "f", "type": ~"spring_dumper", "p": "arm", "s": "ground"}])",
     {"force 'f'", "did you mean \"spring_damper\""}},
    {TWO_BODIES R"("forces": [~{"name": "f", "type": "spring_damper", "stiffness": 1}])", {"force 'f', ", "missing"}},
    {TWO_BODIES R"("forces": [{"name": "f", "type": "spring_damper", "stiffness": 1, "at": ~[0,0,0]}])",
     {"force 'f', at", "neither \"p\" nor \"s\" names a body"}},
    {TWO_BODIES
     R"("markers": [{"name": "m", "body": "arm"}, {"name": "n", "body": "ground"}], "links": [{"name": "A", "type": "revolute", "p": "m", "s": "n", "at": ~[0,0,0]}])",
     {"joint 'A', at", "have a pose already"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0]}, {"name": "G", "type": "revolute", "pairs": ~["A", "A"]}])",
     {"joint 'G', pairs", "2 pairs are given, a revolute has 1"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0]}, ~{"name": "G", "type": "gear", "pairs": ["A", "A"], "teeth_1": 3}])",
     {"joint 'G', teeth_2", "needs the teeth of both"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "stops": [~{"axis": "rz"}]}])",
     {"joint 'A', stops[0]: no limit is given", "add \"low\" or \"high\""}},
    {TWO_BODIES
     R"("links": [{"name": "S", "type": "stop", "p": "arm", "s": "ground", "at": [0,0,0], "coordinate": "rz", "low": 0, "unilateral": {"side": ~"below"}}])",
     {"joint 'S', unilateral.side", "defines its own side"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "friction": ~{"mu": 0.1}}])",
     {"radius", "only rotates"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "friction": {"mu": 0.1, "radius": 1, "mu_static": ~-1}}])",
     {"mu_static", "mu or more"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": [{"axis": "rz", "law": 1}, {"axis": ~"rz", "law": 2}]}])",
     {"drive on rz", "driven already"}},
    // the place is that of the culprit, not that of another thing whose name is in the message
    {TWO_BODIES R"("forces": [{"name": ~"f", "type": "applied_torque", "p": "bob", "torque": [0,0,1]}])",
     {"force 'f'", "body 'bob'", "particle"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "at_p": ~[0,0,0]}])",
     {"joint 'A', at_p", "\"at\" places both markers", "remove one"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "axis": "z", "orientation": ~[1,0,0,0]}])",
     {"joint 'A', orientation", "\"axis\" is given as well"}},
    {TWO_BODIES R"("forces": [{"name": "f", "type": "applied_force", "s": ~"arm", "at": [0,0,0], "force": [0,0,1]}])",
     {"force 'f', s", "\"s\" is given without \"p\""}},
    {TWO_BODIES R"("forces": [~{"name": "f", "type": "applied_force", "force": [0,0,1]}])",
     {"force 'f', p", "missing", "that the force acts on"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": "rz", "law": 1, "speed": ~1}}])",
     {"drive.speed", "\"law\" is given as well", "one of the two"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "stops": [{"axis": "rz", "low": 0, "rest_speed": ~0}]}])",
     {"rest_speed", "it is 0", "above zero"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "stops": [{"axis": "rz", "low": "10 deg", "high": ~"-90 deg"}]}])",
     {"stops[0].high: it is -90 deg, not above \"low\" = 10 deg"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "friction": ~0.1}])",
     {"joint 'A', friction: expected an object", "see lockstep describe friction"}},
    {TWO_BODIES R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": ~"world", "at": [0,0,0]}])",
     {"unknown marker or body \"world\"; did you mean \"ground\"?"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": "rz", ~"velocity": 1}}])",
     {"unknown key \"velocity\"; did you mean \"speed\"?"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "stops": [{"axis": "rz", "low": 0, "restitution": ~2}]}])",
     {"restitution", "it is 2", "between 0 (no rebound) and 1"}},
    {TWO_BODIES
     R"("markers": [{"name": "m", "body": "arm", "rotation": {"type": "axis_rotation", "axis": "x", "law": {"type": "ramp", "slope": 1}}}, {"name": "n", "body": "ground"}], "links": [{"name": "S", "type": "spherical", "p": "m", "s": "n", "stops": [{"axis": ~"rx", "low": 0}]}])",
     {"marker 'm' moves by a law", "joint of type \"stop\""}},
    {TWO_BODIES
     R"("links": [{"name": "S", "type": "stop", "p": "arm", "s": "ground", "at": [0,0,0], "coordinate": "rz", "low": 0, "high": ~1}])",
     {"joint 'S'", "\"low\" is given as well", "a stop has one limit"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "distance", "p": "arm", "s": "ground", "at_p": [1,0,0], "at_s": [0,0,0], "unilateral": {"restitution": ~2}}])",
     {"restitution", "it is 2"}},
    {TWO_BODIES
     R"("links": [{"name": "A", "type": "lock", "mask": ~"x y x", "p": "arm", "s": "ground", "at": [0,0,0]}])",
     {"has the word \"x\" twice", "give it once"}},
    {COUPLED R"(, "move": ~{"type": "constant", "value": [0,0,0]}}])",
     {"joint 'G', move", "cannot have a prescribed pose", "remove it"}},
    {COUPLED R"(, "drive": ~{"axis": "rz", "law": 1}}])", {"joint 'G', drive", "cannot have a drive", "remove it"}},
    {COUPLED R"(}], "forces": [~{"name": "f", "type": "joint_friction", "link": "G", "mu": 0.1, "radius": 1}])",
     {"force 'f'", "joint 'G' (gear) is not a joint of two markers", "revolute, prismatic"}},
    {TWO_BODIES ONE_LINK
     R"("forces": [{"name": "f", "type": "function_force", "link": ~"A", "p": "arm", "s": "ground", "at": [0,0,0], "coordinate": "rz", "torque": "=1"}])",
     {"force 'f', link", "\"p\" and \"s\" are given as well", "either a joint or two markers"}},
    {TWO_BODIES ONE_LINK
     R"("forces": [{"name": "f", "type": "function_force", "link": "A", "coordinate": ~"x", "torque": "=1"}])",
     {"force 'f', coordinate", "a torque is about rx, ry or rz"}},
    {TWO_BODIES ONE_LINK
     R"("forces": [{"name": "f", "type": "function_force", "link": "A", "coordinate": ~"rz", "force": "=1"}])",
     {"force 'f', coordinate", "a force is along x, y, z or distance"}},
    {TWO_BODIES R"("gravity": [0, 0, -9.81], "planar": ~"z")", {"planar with normal z", "-9.81 m/s^2"}},
    {TWO_BODIES
     R"("planar": "z", "links": [{"name": ~"A", "type": "lock", "mask": "x", "p": "arm", "s": "ground", "at": [0,0,0], "axis": [1,1,1]}])",
     {"joint 'A', constraint x", "neither in the plane nor normal to it", "set \"planar\" to \"off\""}},
    {TWO_BODIES
     R"("planar": "z", "links": [{"name": ~"A", "type": "cylindrical", "p": "arm", "s": "ground", "at": [0,0,0], "drive": {"axis": "z", "law": {"type": "ramp", "slope": 1}}}])",
     {"joint 'A', constraint z", "prescribes a motion out of the plane", "set \"planar\" to \"off\""}},
    {TWO_BODIES ONE_LINK
     R"("forces": [{"name": "f", "type": "joint_friction", "link": ~"A", "p": "arm", "s": "ground", "at": [0,0,0], "mu": 0.1, "radius": 1}])",
     {"force 'f', link", "\"p\" and \"s\" are given as well", "remove them"}},
};

const std::vector<Bad> kRuns = {
    {R"("run": {"step": ~0})", {"run.step", "greater than 0"}},
    {R"("run": {"step": ~-0.1})", {"-0.1"}},
    {R"("run": {"tolerance": ~0})", {"tolerance is 0"}},
    {R"("run": {"tolerance": ~1e9})", {"1e+09", "many times larger than the motion"}},
    {R"("run": {"until": ~-1})", {"-1"}},
    {R"("run": {"integrator": ~"rk5"})", {"run.integrator", "unknown integrator \"rk5\"", "did you mean \"rk4\""}},
    {R"("run": {"integrator": ~"rk4"})", {"fixed steps", "\"step\""}},
    {R"("run": {"solver": ~"sparce"})", {"did you mean \"sparse\""}},
    {R"("run": {"formulation": ~"omegas"})", {"did you mean \"omega\""}},
    {R"("run": {"stabilization": ~"projekt"})", {"did you mean \"project\""}},
    {R"("run": {"stabilization": {"kind": "baumgarte", "alpha": ~-1}})", {"alpha", ">= 0"}},
    {R"("run": {"stabilization": {"kind": "baumgarte", "alpha": ~"5 Hz"}})", {"alpha", "a number"}},
    {R"("run": {"times": ~[0, 2, 1]})", {"rise", "1 s follows 2 s"}},
    {R"("run": {"output": 1, "times": ~[0]})", {"remove one"}},
    {R"("run": {"record": ["a.x", ~"a.x"]})", {"requested twice"}},
    {R"("run": {"record": [~3]})", {"run.record", "number"}},
    {TWO_BODIES R"("run": {"record": [~"arm.w"]})", {"arm"}},
    {TWO_BODIES R"("run": {"record": [{"a": ~"amr.x"}]})", {"arm"}},
    {TWO_BODIES ONE_LINK R"("events": [{"name": "e", "at": 1, "deactivate": [~"B"]}])",
     {"event 'e', deactivate", "unknown joint or force \"B\""}},
    {TWO_BODIES ONE_LINK R"("events": [{"name": "e", "at": ~-1, "stop": true}])",
     {"event 'e', at", "before the start"}},
    {TWO_BODIES ONE_LINK R"("events": [~{"name": "e", "stop": true}])", {"\"at\" or \"when\""}},
    {TWO_BODIES ONE_LINK R"("events": [~{"name": "e", "at": 1}])", {"event 'e': the event does nothing"}},
    {TWO_BODIES ONE_LINK R"("events": [{"name": "e", "when": {"channel": ~"arm.xx"}, "stop": true}])",
     {"event 'e'", "arm"}},
    {R"(~"gravitiy": [0,0,0])", {"scene", "did you mean \"gravity\""}},
    {R"("gravity": ~[0, "9,81 m/s^2", 0])", {}},
    {R"("run": {"step": 1 ~"until": 2})", {"comma"}},
    {R"("run": {"times": ~[-1, 2]})", {"time -1 s is before the start"}},
    {R"("run": {"record": [~"a\nb"]})", {"line end or another control character", "remove it"}},
    {R"("run": {"draw": ~3})", {"run.draw", "expected a list of panels", "a number (3)"}},
    {R"("run": {"nearly_redundant": ~"maybe"})", {"nearly_redundant", "maybe"}},
    {TWO_BODIES ONE_LINK R"("events": [{"name": "e", "at": 1, "activate": ["A"], "deactivate": ~["A"]}])",
     {"event 'e', deactivate", "'A' is activated and deactivated at the same time"}},
    {TWO_BODIES ONE_LINK R"("events": [{"name": "e", "at": 1, "activate": ~"A"}])",
     {"event 'e', activate", "expected a list of texts"}},
    {R"("requires": ~"drag")", {"requires", "expected a list of texts"}},
};

// A law of the turn of the link A, and things of the link B along whose z a particle slides.
std::string turning(const std::string& law) {
  return R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}], )"
         R"("links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], )"
         R"("drive": {"axis": "rz", "law": )" +
         law + "}}]";
}
std::string sliding(const std::string& things) {
  return R"("bodies": [{"name": "b", "particle": 1}], "links": [{"name": "B", "type": "point_on_line", "p": "b", )"
         R"("s": "ground", "at": [0,0,0])" +
         things;
}

const std::vector<Bad> kUnits = {
    {turning(R"({"type": "ramp", "slope": ~"3 m/s"})"), {"joint 'A', drive.law.slope", "a speed", "an angular speed"}},
    {turning(R"({"type": "ramp", "slope": 1, "y0": ~"5 kg"})"), {"drive.law.y0", "a mass", "an angle"}},
    {turning(R"(~"5 mm")"), {"joint 'A', drive.law: ", "a length", "an angle"}},
    {turning(R"({"type": "polynomial", "coefficients": ["1 deg", "2 rpm", ~"3 m/s^2"]})"),
     {"drive.law.coefficients[2]", "an angular acceleration"}},
    {turning(R"({"type": "sum", "laws": [1, {"type": "sine", "omega": 1, "amplitude": ~"5 mm"}]})"),
     {"drive.law.laws[1].amplitude", "an angle"}},
    {turning(
         R"({"type": "shift", "delay": 1, "law": {"type": "spline", "points": [[0, 0], ["5 ms", ~"3 mm"], [1, 1]]}})"),
     {"drive.law.law.points[1][1]", "an angle"}},
    {turning(R"({"type": "spline", "points": [[0, 0], [~"5 mm", "3 deg"], [1, 1]]})"), {"points[1][0]", "a time"}},
    {turning(R"({"type": "trapezoid", "distance": 1, "speed": "30 rpm", "acceleration": ~"3 m/s^2"})"),
     {"drive.law.acceleration", "an angular acceleration"}},
    {sliding(R"(, "drive": {"axis": "z", "speed": {"type": "ramp", "slope": ~"3 m/s"}}}])"),
     {"joint 'B', drive.speed.slope", "a speed", "an acceleration"}},
    {sliding(R"(, "stops": [{"axis": "z", "low": ~"5 deg"}]}])"), {"joint 'B', stops[0].low", "an angle", "a length"}},
    {sliding(
         R"(}, {"name": "C", "type": "stop", "p": "b", "s": "ground", "at": [0,0,0], "coordinate": "z", "low": ~"5 deg"}])"),
     {"joint 'C', low", "an angle", "a length"}},
    {sliding(R"(}], "events": [{"name": "e", "stop": true, "when": {"channel": "b.z", "crosses": ~"5 kg"}}])"),
     {"event 'e', when.crosses", "\"5 kg\"", "in m is expected"}},
    {sliding(R"(}], "events": [{"name": "e", "stop": true, "when": {"channel": "energy.total", "crosses": ~"5 kg"}}])"),
     {"when.crosses", "in J is expected"}},
    {sliding(R"(, "stops": [{"axis": "z", "low": 0, "rest_speed": ~"5 kg"}]}])"), {"rest_speed", "neither a speed"}},
    {turning(R"({"type": "shift", "delay": 1, "law": ~"5 mm"})"), {"drive.law.law", "an angle"}},
    {turning(R"({"type": "formula", "y": ~"=3 m"})"), {"joint 'A', drive.law.y", "a length", "an angle"}},
    {turning(R"({"type": "formula", "y": ~"=3 kg*t"})"), {"drive.law.y", "kg s", "an angle", "t is a time"}},
    {turning(R"({"type": "formula", "y": ~"=1 m + t"})"), {"drive.law.y", "a length and a time are added"}},
    {turning(R"({"type": "formula", "y": ~"=L*t", "parameters": {"L": "100 mm"}})"),
     {"drive.law.y", "m s", "an angle"}},
    {R"("parameters": {"L": "100 mm"}, )" + turning(R"({"type": "formula", "y": ~"=L*t"})"),
     {"drive.law.y", "an angle"}},
    {turning(R"({"type": "sum", "laws": [1, {"type": "formula", "y": ~"=t*1 s"}]})"),
     {"drive.law.laws[1].y", "s^2", "an angle"}},
    {sliding(R"(, "drive": {"axis": "z", "speed": {"type": "formula", "y": ~"=3 m"}}}])"),
     {"joint 'B', drive.speed.y", "a length", "a speed"}},
    {R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}], )" ONE_LINK
     R"("forces": [{"name": "f", "type": "torque_motor", "p": "arm", "s": "ground", "at": [0,0,0], "torque": {"type": "formula", "y": ~"=3 mm"}}])",
     {"force 'f', torque.y", "a length", "a torque"}},
    {sliding(R"(}], "forces": [{"name": "f", "type": "applied_force", "p": "b", "at": [0,0,0], "direction": "x", )"
             R"("law": {"type": "ramp", "slope": ~"3 N"}}])"),
     {"force 'f', law.slope", "a force", "a force per second is expected (a number in N/s)"}},
    {sliding(
         R"(}], "markers": [{"name": "m", "body": "b", "translation": {"type": "along", "axis": "x", "law": ~"3 rad"}}])"),
     {"marker 'm', translation.law", "an angle", "a length"}},
};

const std::vector<Bad> kLaws = {
    {turning(R"({"type": "spline", "points": [[0, 0], [1, 1], [2, 0]], "start_rate": ~1})"), {"clamped ends only"}},
    {turning(R"({"type": "spline", "points": [[0, 0], [1, 1], [2, 0]], "ends": "clamped", "start_acceleration": ~1})"),
     {"degree 5 only"}},
    {turning(R"({"type": "sequence", "durations": ~[1, 1], "laws": [{"type": "ramp", "slope": 1}]})"),
     {"drive.law.durations", "are 2 for 1 laws"}},
};

void check_all(const std::vector<Bad>& all) {
  for (const Bad& bad : all) {
    std::string line = bad.line;
    const std::size_t column = line.find('~') + 1;
    REQUIRE(column > 0);
    line.erase(column - 1, 1);
    INFO(bad.line);
    const std::string message = refusal_of("{\"lockstep\": 1,\n" + line + "\n}");
    INFO(message);
    if (!bad.words.empty()) CHECK(message.rfind("bad.json:2:" + std::to_string(column) + ": ", 0) == 0);
    CHECK(message.rfind("bad.json:2:", 0) == 0);
    for (const std::string& word : bad.words) {
      INFO(word);
      CHECK(message.find(word) != std::string::npos);
    }
  }
}

}  // namespace

TEST_CASE("an impossible body is rejected at its place", "[unit][scene]") { check_all(kBodies); }
TEST_CASE("an impossible joint, marker or force is rejected at its place", "[unit][scene]") { check_all(kLinks); }
TEST_CASE("an impossible run is rejected at its place", "[unit][scene]") { check_all(kRuns); }

TEST_CASE("an impossible law is rejected at its place", "[unit][scene]") { check_all(kLaws); }
TEST_CASE("a unit that does not fit the driven coordinate is rejected at its place", "[unit][scene]") {
  check_all(kUnits);
}

TEST_CASE("units that fit what a law drives are read", "[unit][scene]") {
  const auto accepted = [](const std::string& line) { return refusal_of("{\"lockstep\": 1,\n" + line + "\n}"); };
  for (const char* law :
       {R"("90 deg")", R"({"type": "ramp", "slope": "30 rpm", "y0": "1 rev"})",
        R"({"type": "polynomial", "coefficients": ["1 deg", "2 rpm", "3 deg/s^2"]})",
        R"({"type": "product", "laws": ["2 mm", {"type": "ramp", "slope": "3 1/s"}]})",
        R"({"type": "scale", "factor": "2 1/m", "offset": "3 deg", "law": {"type": "ramp", "slope": "3 m/s"}})"}) {
    INFO(law);
    CHECK(accepted(turning(law)) == "accepted");
  }
  CHECK(accepted(
            sliding(R"(, "drive": {"axis": "z", "speed": {"type": "ramp", "slope": "3 mm/s^2", "y0": "1 m/s"}}}])")) ==
        "accepted");
  // Of an angle, not of time.
  const std::string cam =
      R"("bodies": [{"name": "cam", "sphere": {"mass": 1, "radius": 1}}, {"name": "b", "particle": 1, "position": [1,0,0]}], )"
      R"("links": [{"name": "C", "type": "cam_roller", "p": "b", "s": "cam", "at_p": [1,0,0], "at_s": [0,0,0], "radius": )"
      R"({"type": "spline", "ends": "periodic", "outside": "repeat", )"
      R"("points": [["0 deg", "1 m"], ["180 deg", "1.1 m"], ["360 deg", "1 m"]]}}])";
  CHECK(accepted(cam) == "accepted");
  CHECK(accepted(sliding(
            R"(}], "events": [{"name": "e", "stop": true, "when": {"channel": "b.vz", "crosses": "5 mm/s"}}])")) ==
        "accepted");
}

TEST_CASE("a column in a unit that does not fit its coordinate is rejected with its place", "[unit][scene]") {
  const std::string file = std::string(paths::kBuild) + "/scene_errors_columns.csv";
  std::ofstream(file) << "t [ms],lift [mm],turn [deg],plain,speed [mm/s],late [deg],x [mm],y [m],z [-]\n"
                         "0,0,0,0,0,0,0,0,0\n500,1,2,3,4,5,6,7,8\n1000,2,4,6,8,10,12,14,16\n";
  const auto spline = [&](const std::string& y, const std::string& t = "t") {
    return R"({"type": "spline", "file": ")" + file + R"(", "t_column": ")" + t + R"(", "y_column": ")" + y + R"("})";
  };
  const auto refusal = [](const std::string& line) { return refusal_of("{\"lockstep\": 1,\n" + line + "\n}"); };
  const auto along = [&](const std::string& law, const char* key = "law") {
    return refusal(sliding(R"(, "drive": {"axis": "z", ")" + std::string(key) + R"(": )" + law + "}}]"));
  };
  using lockstep::testing::check_words;
  check_words(refusal(turning(spline("lift"))),
              {"bad.json:2:", "joint 'A', drive.law.y_column: column 'lift' of " + file, "in [mm]",
               "a length; here an angle is expected"});
  check_words(along(spline("turn")), {"joint 'B', drive.law.y_column: column 'turn'", "[deg]", "an angle", "a length"});
  check_words(along(spline("lift"), "speed"),
              {"drive.speed.y_column: column 'lift'", "a length", "a speed is expected"});
  check_words(along(spline("lift", "late")), {"drive.law.t_column: column 'late'", "an angle", "a time is expected"});
  check_words(along(R"({"type": "sum", "laws": [1, )" + spline("3") + "]}"),
              {"drive.law.laws[1].y_column: column 'turn'"});
  const std::string path =
      R"(}], "markers": [{"name": "m", "body": "b", "translation": {"type": "path", "file": ")" + file;
  check_words(refusal(sliding(path + R"(", "y_column": "turn"}}])")), {"marker 'm', translation.y_column", "an angle"});

  CHECK(refusal(turning(spline("turn"))) == "accepted");
  CHECK(refusal(turning(spline("plain"))) == "accepted");
  CHECK(along(spline("lift")) == "accepted");
  CHECK(along(spline("speed"), "speed") == "accepted");
  CHECK(refusal(sliding(path + "\"}}]")) == "accepted");
}

TEST_CASE("a text that is no scene is reported as such", "[unit][scene]") {
  CHECK(refusal_of("[]").find("expected an object") != std::string::npos);
  CHECK(refusal_of("{}").find("missing key \"lockstep\"") != std::string::npos);
  CHECK(refusal_of("{\"lockstep\": 2}").find("this program reads version 1") != std::string::npos);
  CHECK(refusal_of("{\"lockstep\": 1, \"bodies\": [").find("closing ] is missing") != std::string::npos);
  CHECK(refusal_of("{\"lockstep\": 1, \"run\": " + std::string(70, '[') + std::string(70, ']') + "}").find("64") !=
        std::string::npos);
  testing::check_words(testing::message_of<FileError>([] { read_scene("no_such_scene.json"); }),
                       {"cannot read 'no_such_scene.json'", "check the path"});
}

TEST_CASE("a joint between bodies that stand still has nothing to hold", "[unit][scene]") {
  const std::string message = refusal_of(R"({"lockstep": 1, "bodies": [{"name": "base", "fixed": true}],
    "links": [{"name": "A", "type": "fixed", "p": "base", "s": "ground", "at": [0,0,0]}]})");
  CHECK(message.find("joint 'A', s: bodies 'base' and 'ground' are both fixed") != std::string::npos);
}

}  // namespace scene_errors_test
