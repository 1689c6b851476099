// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/describe.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <lockstep/text.h>
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

struct Word {
  const char *name, *text;
};

// Forms that a value may have.
constexpr Word kForms[] = {
    {"number",
     R"_(a number in SI units, a text with a unit, or a formula of the scene's parameters
  0.012    "12 mm"    "=2*crank + 5 mm")_"},
    {"quantity",
     R"_(a number whose unit depends on the object: m for a translation, rad for a rotation, and the units of their rates
  0.1    "100 mm"    "30 deg"    "=2*gap")_"},
    {"vector3",
     R"_(three numbers in SI units or texts with units, the name of one of the scene's "points", or a formula
  [0, 0.2, 0]    [0, "20 cm", 0]    "A"    "=A + [crank, 0, 0]")_"},
    {"axis",
     R"_(a direction: "x", "y" or "z", one of these with a minus sign, or a vector of any length except zero
  "z"    "-y"    [1, 1, 0])_"},
    {"orientation",
     R"_(an orientation of one frame in another, in one of five forms; a quaternion has its scalar first and length 1.
Each of three angles rotates about an axis already rotated by the ones before. The sequence is three of x, y, z, or
a name: cardan (xyz), euler (zxz), hpb (zxy).
  [1, 0, 0, 0]
  {"axis": "z", "angle": "30 deg"}
  {"angles": ["10 deg", "20 deg", "30 deg"], "sequence": "zxz"}
  {"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}
  {"x": [1, 1, 0], "z": [0, 0, 1]}    directions of two of the axes x, y, z, at right angles)_"},
    {"law",
     R"_(a function of time y(t): an object with its type and keys (`lockstep list laws`), or a number for a constant
  {"type": "sine", "omega": "2 rad/s", "amplitude": "10 mm"}
  {"type": "formula", "y": "=0.1*sin(3*t)"}
  "30 mm")_"},
    {"translation law",
     R"_(a vector as a function of time: an object with its type and keys (`lockstep list laws`), or [x, y, z] for a constant
  {"type": "components", "x": {"type": "ramp", "slope": "1 m/s"}})_"},
    {"rotation law",
     R"_(a rotation as a function of time: an object with its type and keys (`lockstep list laws`), or an orientation for a constant
  {"type": "axis_rotation", "axis": "z", "law": {"type": "ramp", "slope": "60 rpm"}})_"},
    {"channel",
     R"_(the name of a quantity that a scene can record, draw or use in an event: "crank.x", "A.force_on_p_world_x",
"energy.total"; "crank.x@rocker" is relative to another body. `lockstep check SCENE --channels` lists those of a scene.
  "record": ["crank.x", {"torque": "A.drive.torque_on_p_link_z"}])_"},
    {"formula",
     R"_(a text that begins with "=": + - * / ^, comparisons, c ? a : b, functions and constants. In a scene it can use
"parameters", "points", positions of bodies, and units; in a law t; in a function joint x y z, rz, e0 e1 e2 e3 and t.
Of points there are meet(A, r, B, s, left), where circles about A and B meet, and meet(A, B, C, D) of two lines; of the
scene's "tables" table(gas, x), where x has the unit of the first column. Of the motion, in columns: min(x), max(x), mean(x),
rms(x), integral(x), at(x, time), last(x, T) as in mean(last(x, 0.2 s)), and rate(x), the derivative by time.
  "=sqrt(a^2 + b^2)"    "=A + crank*[cos(phi), sin(phi), 0]"    "=rod.to - rod.from"    "=0.1*sin(w*t) + (t > 1 ? 2*(t-1)^2 : 0)")_"},
    {"unit",
     R"_(a text with a unit is converted to SI: m g s N Nm J W Hz rad Pa bar l with prefixes n u m c d h k M G; deg, rev, turn, rpm,
min, h, t, in, ft, kgf, hp, psi; products, powers and one group of divisors. A unit of another quantity is an error.
  "12 mm"    "1200 rpm"    "0.3 g/cm^3"    "5 N m/rad")_"}};

// Whether it is one of the functions that the text of formulas lists.
bool is_function(const Word& form, const std::string& word) {
  const std::string_view text = form.text;
  const std::size_t at = text.find(word + "(");
  return form.name == std::string_view("formula") && at != std::string::npos &&
         (text[at - 1] == ' ' || text[at - 1] == '\n');
}

// "stops, a key of link: list of objects: see ...", owners of the same meaning together.
std::string key_lines(const Registry& registry, const std::string& word) {
  std::vector<std::pair<std::string, std::vector<std::string>>> meanings;
  for (const Description& d : all_descriptions(registry))
    for (const Key& key : d.info.keys) {
      if (key.name != word) continue;
      const std::string form = form_words(key, d.parts);
      const std::string meaning = key.help + (form.empty() ? "" : " (" + form + ")");
      auto same = std::ranges::find(meanings, meaning, [](const auto& m) { return m.first; });
      if (same == meanings.end()) same = meanings.insert(meanings.end(), {meaning, {}});
      if (std::ranges::find(same->second, d.info.name) == same->second.end()) same->second.push_back(d.info.name);
    }
  std::string text;
  for (const auto& [meaning, owners] : meanings) text += "  of " + text::join(owners) + ": " + meaning + "\n";
  return text.empty() ? "" : word + ": a key\n" + text;
}

}  // namespace

std::string describe_word(const Registry& registry, const std::string& word) {
  std::string text;
  for (const Word& form : kForms)
    if (word == form.name || word == std::string(form.name) + "s" || is_function(form, word))
      text += word + ": " + form.text + "\n";
  for (const Unit unit : units())
    if (word == name_of(unit))
      text += word + ": a quantity in " + si_unit(unit) + ", or a text with a unit: \"" + example_of(unit) + "\"\n";
  return text + key_lines(registry, word);
}

std::vector<std::string> known_words(const Registry& registry) {
  const std::vector<Description> described = all_descriptions(registry);
  std::set<std::string> words;
  for (const Word& form : kForms) words.insert(form.name);
  for (const Unit unit : units()) words.insert(name_of(unit));
  for (const Description& d : described)
    for (const Key& key : d.info.keys) words.insert(key.name);
  std::vector<std::string> all;
  for (const Description& d : described) all.push_back(d.info.name);
  all.insert(all.end(), words.begin(), words.end());
  return all;
}

}  // namespace lockstep
