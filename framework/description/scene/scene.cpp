#include <lockstep/scene.h>

#include <algorithm>

#include <lockstep/loader.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/json.h"
#include "framework/description/scene/old_names.h"
#include "framework/description/scene/read.h"
#include "framework/description/scene/resolve.h"
#include "framework/description/scene/run_settings.h"

namespace lockstep {
namespace {

constexpr int kFormat = 1;

}  // namespace

Scene scene_from(Value root, std::string file) {
  Scene scene;
  scene.root = std::move(root);
  scene.file = std::move(file);
  if (scene.root.object() == nullptr)
    refuse(scene.root.where, "scene", "expected an object ({\"lockstep\": 1, ...}), got " + shown(scene.root));
  rename_old_keys(scene.root);
  resolve_formulas(scene, {scene.file});
  const Params p = params_of(scene.root, "scene", "scene", nullptr);
  if (p.integer("lockstep") != kFormat)
    p.refuse("lockstep", "version " + std::to_string(p.integer("lockstep")) +
                             " of the format is unknown here; this program reads version " + std::to_string(kFormat));
  if (p.has("title")) scene.title = p.text("title");
  if (p.has("description")) scene.description = p.text("description");
  for (auto [name, where] : texts_of(p, "requires")) {
    if (!is_bare_name(name)) {
      std::replace_if(
          name.begin(), name.end(), [](char c) { return c >= 0 && c < ' '; }, '?');
      refuse(where, "scene, requires",
             "\"" + name +
                 "\" is not a bare name; a scene names plugins, as in \"cam_follower\", and where they may come "
                 "from is given outside of it: by --plugin PATH or LOCKSTEP_PLUGIN_PATH");
    }
    scene.plugins.push_back(name);
  }
  scene.run = with_formulas(scene, [&] { return read_run(p.value("run")); });
  return scene;
}

Scene scene_from_text(const std::string& text, const std::string& file) {
  return scene_from(read_json(text, file), file);
}

Scene read_scene(const std::string& path) { return scene_from(read_json_file(path), path); }

}  // namespace lockstep
