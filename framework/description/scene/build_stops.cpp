// SPDX-License-Identifier: BSD-3-Clause
// Attributes of a joint: one-sided, stops of its travel, friction.

#include <lockstep/forces.h>
#include <lockstep/text.h>
#include "framework/description/registry/law_units.h"
#include "framework/description/scene/builder.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

Unilateral unilateral_from(const Params& p) {
  Unilateral o;
  if (const std::string* given = p.value("rest_speed").text();
      given && !misfit(*given, "m/s").empty() && !misfit(*given, "rad/s").empty())
    p.refuse("rest_speed", "\"" + *given + "\" is neither a speed nor an angular speed; write one, as in \"1 mm/s\"");
  o.restitution = p.number("restitution");
  o.rest_speed = p.number("rest_speed");
  if (!(o.restitution >= 0 && o.restitution <= 1))
    p.refuse("restitution",
             "it is " + text::number(o.restitution) + "; it must be between 0 (no rebound) and 1 (no loss)");
  if (!(o.rest_speed > 0))
    p.refuse("rest_speed",
             "it is " + plain_text(p.value("rest_speed")) + "; it must be above zero, or the rebounds would never end");
  return o;
}

// Axes in which the axis k of the old ones is z: x y z -> y z x for k = 0, z x y for k = 1.
Quat axes_with_z(int k) {
  Mat3 A = Mat3::Zero();
  for (int j = 0; j < 3; ++j) A((k + 1 + j) % 3, j) = 1;
  return quaternion_of(A);
}

}  // namespace

void Builder::unilateral(const Params& link, Lock& lock) {
  if (!link.has("unilateral")) return;
  const Params p = params_under(link, "unilateral", "unilateral");
  const std::string side = p.text("side");
  const bool its_own = lock.unilateral() != nullptr;  // as a stop has
  if (its_own && p.has("side")) p.refuse("side", "a " + std::string(lock.type()) + " defines its own side; remove it");
  Unilateral u = unilateral_from(p);
  u.below = side == "below";
  lock.set_unilateral(u);
}

void Builder::brought_along(const Params& link, const Attachment& attachment, Lock& lock) {
  for_each_object(link, "stops", [&](const Value& v, const std::string& owner) { stops(v, owner, attachment); });
  if (!link.has("friction")) return;
  const Value& keys = link.value("friction");
  const std::string name = attachment.name + ".friction";
  const Params friction = params_under(link, "friction", "friction");
  const Attachment where{name, {}, &lock};
  placed(keys.where, [&] { system_.add(registry_.forces.make_checked("joint_friction", where, friction)); });
  taken_[0][name] = {"force", keys.where};
}

// One or both ends of one coordinate.
void Builder::stops(const Value& object, const std::string& owner, const Attachment& of) {
  const Params p = params_of(object, "travel", owner, nullptr);
  const Axis axis = axis_from(p.text("axis"));
  const Unilateral options = unilateral_from(p);
  if (const Jointed* joint = system_.link(of.name).jointed(); joint != nullptr && includes(joint->mask(), row_of(axis)))
    p.refuse("axis", "the joint constrains " + p.text("axis") + ", so it has no travel; name a free coordinate");
  if (!p.has("low") && !p.has("high")) p.refuse("", "no limit is given; add \"low\" or \"high\"");
  const Unit unit = is_rotation(axis) ? Unit::angle : Unit::length;
  for (const char* key : {"low", "high"}) check_unit(p, key, unit);
  check_unit(p, "rest_speed", unit, 1);
  if (p.has("low") && p.has("high") && !(p.number("low") < p.number("high")))
    p.refuse("high", "it is " + plain_text(p.value("high")) + ", not above \"low\" = " + plain_text(p.value("low")) +
                         "; exchange them");
  for (const char* end : {"low", "high"}) {
    if (!p.has(end)) continue;
    Attachment attachment{of.name + ".stop_" + p.text("axis") + "_" + end, {}};
    Marker *P = &of.p(), *S = &of.s();
    std::string coordinate = p.text("axis");
    if (axis == Axis::rx || axis == Axis::ry) {  // a stop counts revolutions about z: markers with z there
      for (const Marker* m : {P, S})
        if (m->translation_law || m->rotation_law)
          p.refuse("axis", "marker '" + m->name +
                               "' moves by a law, so a stop about x or y needs other markers; add a joint of type "
                               "\"stop\"");
      const Pose turned{Vec3::Zero(), axes_with_z(axis_index(axis) - 3)};
      P = &system_.add_marker(attachment.name + ".P", *P->body, P->local * turned);
      S = &system_.add_marker(attachment.name + ".S", *S->body, S->local * turned);
      coordinate = "rz";
    }
    attachment.pairs.emplace_back(P, S);
    placed(object.where, [&] {
      const Params keys{{"coordinate", coordinate}, {end, p.number(end)}};
      std::unique_ptr<Lock> stop = registry_.links.make("stop", attachment, keys, &registry_, owner);
      stop->set_unilateral(options);
      system_.add(std::move(stop));
    });
    taken_[0][attachment.name] = {"link", object.where};
  }
}

}  // namespace lockstep
