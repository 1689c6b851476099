// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/scene.h>

#include <algorithm>

#include <lockstep/author/loader.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/json.h"
#include "framework/description/scene/reading.h"
#include "framework/mechanism/params/refusals.h"

namespace lockstep {
namespace {

constexpr int kFormat = 1;

// A scene names a plugin; its location is given outside of the scene.
void check_plugin(std::string name, const SourceLocation& where) {
  if (is_bare_name(name)) return;
  std::ranges::replace_if(
      name, [](char c) { return c >= 0 && c < ' '; }, '?');
  refuse(where, "scene, requires",
         "\"" + name +
             "\" is not a bare name such as \"cam_follower\"; give the path by --plugin PATH or LOCKSTEP_PLUGIN_PATH");
}

}  // namespace

void check_format(const Value& root) {
  const Value* format = root.find("lockstep");
  const double* version = format != nullptr ? format->number() : nullptr;
  if (version != nullptr && *version != kFormat)
    refuse(format->where, "scene, lockstep",
           "version " + text::number(*version) + " of the format is unknown; this program reads version " +
               std::to_string(kFormat));
}

void read_root(Scene& scene) {
  Refusals wrong;
  std::vector<ChannelRequest> require;
  wrong.attempt([&] {
    const Params p = params_of(scene.root, "scene", "scene", nullptr);
    wrong.attempt([&] { require = read_require(p); });
    if (p.has("title")) scene.title = p.text("title");
    if (p.has("description")) scene.description = p.text("description");
    for (const std::pair<std::string, SourceLocation>& plugin : texts_of(p, "requires")) {
      wrong.attempt([&] { check_plugin(plugin.first, plugin.second); });
      scene.plugins.push_back(plugin.first);
    }
  });
  const Value* run = scene.root.find("run");
  wrong.attempt([&] { scene.run = with_formulas(scene, [&] { return read_run(run != nullptr ? *run : Value()); }); });
  scene.run.require = std::move(require);
  wrong.attempt([&] { read_columns(scene); });
  wrong.raise();
}

Scene scene_from(Value root, std::string file) { return scene_from(std::move(root), std::move(file), {}); }

Scene scene_from(Value root, std::string file, const IncludeRule& rule, bool again) {
  Scene scene;
  scene.root = std::move(root);
  scene.file = std::move(file);
  if (scene.root.object() == nullptr)
    refuse(scene.root.where, "scene", "expected an object ({\"lockstep\": 1, ...}), got " + shown(scene.root));
  check_format(scene.root);
  rename_joints(scene.root);
  SceneReading reading{{scene.file}, rule};
  resolve_formulas(scene, reading);
  read_root(scene);
  if (!again) tell_left_out(scene.root, reading);
  return scene;
}

Scene scene_from_text(const std::string& text, const std::string& file) {
  return scene_from(read_json(text, file), file);
}

Scene read_scene(const std::string& path) { return scene_from(read_json_file(path), path); }

}  // namespace lockstep
