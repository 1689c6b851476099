// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/linear_input_types.h"

#include <utility>

#include <lockstep/author/force.h>
#include <lockstep/error.h>

namespace lockstep {
namespace {

std::shared_ptr<InputLaw>& input_of(const std::shared_ptr<InputLaws>& all, const Params& params) {
  return all->at(static_cast<std::size_t>(params.integer("number")));
}

std::shared_ptr<InputLaw>& made_input(const std::shared_ptr<InputLaws>& all, const Params& params) {
  std::shared_ptr<InputLaw>& input = input_of(all, params);
  if (!input) input = std::make_shared<InputLaw>();
  return input;
}

// x = law(t) + u e
class InputAlong final : public TranslationLaw {
 public:
  InputAlong(LawPtr<TranslationLaw> law, int axis, std::shared_ptr<InputLaw> input)
      : law_(std::move(law)), axis_(axis), input_(std::move(input)) {}
  TranslationValue at(double t) const override {
    TranslationValue x = law_->at(t);
    const LawValue u = input_->at(t);
    x.x[axis_] += u.y, x.v[axis_] += u.yd, x.a[axis_] += u.ydd;
    return x;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { law_->breakpoints(t0, t1, out); }

 private:
  LawPtr<TranslationLaw> law_;
  int axis_;
  std::shared_ptr<InputLaw> input_;
};

// The ends of a force: its own markers, or those of the joint in which it acts; without S the ground.
std::pair<const Marker*, const Marker*> ends_of(const Attachment& attachment, const Params& params) {
  if (attachment.link != nullptr) return attachment.link->pairs().front();
  return {&p_of(attachment, params), has_s(attachment) ? &s_of(attachment, params) : nullptr};
}

//   f = u e_k of S (of the world, without S)
std::unique_ptr<Force> input_force(const Attachment& attachment, const Params& params,
                                   std::shared_ptr<InputLaw> input) {
  const auto ends = ends_of(attachment, params);
  const Marker *const p = ends.first, *const s = ends.second;
  const int axis = static_cast<int>(params.integer("along"));
  if (axis >= 3 && p->body->freedoms == Freedoms::particle)
    throw ModelError("input '" + attachment.name + "' is a torque on '" + p->body->name +
                     "', which is a particle and cannot rotate; name a force along x, y or z");
  std::vector<const Marker*> markers{p};
  if (s != nullptr) markers.push_back(s);
  return function_force(attachment.name, std::move(markers),
                        [=, input = std::move(input)](const Inputs& in, WrenchSum& out) {
                          const double u = input->at(in.t).y;
                          if (u == 0) return;
                          const MarkerFrame P(*p), S = s != nullptr ? MarkerFrame(*s) : MarkerFrame();
                          const Vec3 f = u * in_world(S, in).A.col(axis % 3);
                          if (axis >= 3) {
                            out.torque(P.slot, f), out.torque(S.slot, -f);
                          } else {
                            const Vec3 x = in_world(P, in).x;
                            out.force(P.slot, f, x), out.force(S.slot, -f, x);
                          }
                        });
}

}  // namespace

void add_input_types(Registry& registry, const std::shared_ptr<InputLaws>& laws) {
  const Key number{"number", Form::integer, Unit::none, kRequired, "number of the input, from 0"},
      axis{"axis", Form::integer, Unit::none, kRequired, "0 to 2: x, y, z"},
      along{"along", Form::integer, Unit::none, kRequired, "0 to 2: along x, y, z of S; 3 to 5: about them"};
  TypeInfo law{kInputLaw,
               "a law of the scene, and the input of a linearisation",
               {number, {"law", Form::law, Unit::none, kOptional, "the law of the scene", {}, LawQuantity::value}}};
  registry.laws.add(std::move(law), [laws](const Params& params) -> LawPtr<MotionLaw> {
    std::shared_ptr<InputLaw>& input = input_of(laws, params);
    if (!input) input = std::make_shared<InputLaw>(params.has("law") ? params.law("law") : nullptr);
    return input;
  });
  TypeInfo translation{kInputTranslation,
                       "a translation of the scene, and the input of a linearisation along an axis",
                       {number, axis, {"law", Form::translation_law, Unit::length, kRequired, "the law of the scene"}}};
  registry.translation_laws.add(std::move(translation), [laws](const Params& params) -> LawPtr<TranslationLaw> {
    return std::make_shared<InputAlong>(params.translation_law("law"), static_cast<int>(params.integer("axis")),
                                        made_input(laws, params));
  });
  TypeInfo force{kInputForce, "the input of a linearisation between the ends of a force", {number, along}};
  registry.forces.add(std::move(force), [laws](const Attachment& attachment, const Params& params) {
    return input_force(attachment, params, made_input(laws, params));
  });
}

}  // namespace lockstep
