// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/run_outputs.h"

#include <algorithm>

#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/mechanism/params/refusals.h"

namespace lockstep {
namespace {

// The name of a column that is recorded, under this key.
std::string recorded_name(const Params& picture, const char* key, const std::vector<ChannelRequest>& record) {
  std::vector<std::string> known{"t"};
  for (const ChannelRequest& r : record) known.push_back(r.column());
  const std::string name = picture.text(key);
  if (std::find(known.begin(), known.end(), name) == known.end())
    picture.refuse(key, "\"" + name + "\" is not recorded" + text::suggestion(name, known));
  return name;
}

}  // namespace

RunOutputs read_outputs(const Value& run, const std::vector<ChannelRequest>& record) {
  RunOutputs out;
  const Params p = params_of(run, "run", "run", nullptr);
  out.units = p.text("headers") == "units";
  const Value::List& pictures = objects_of(p, "pictures");
  Refusals wrong;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    wrong.attempt([&] {
      const Params picture = params_of(pictures[i], "picture", item("run.pictures", i), nullptr);
      Refusals here;
      out.pictures.emplace_back();
      here.attempt([&] { out.pictures.back().x = recorded_name(picture, "x", record); });
      here.attempt([&] { out.pictures.back().y = recorded_name(picture, "y", record); });
      here.raise();
    });
  wrong.raise();
  return out;
}

RunOutputs outputs_of(const Scene& scene) {
  const Value* run = scene.root.find("run");
  return run != nullptr ? read_outputs(*run, scene.run.record) : RunOutputs{};
}

}  // namespace lockstep
