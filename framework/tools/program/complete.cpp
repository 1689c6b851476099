#include "framework/tools/program/complete.h"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <lockstep/recorder.h>
#include <lockstep/text.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/words.h"
#include "framework/tools/program/options.h"

namespace lockstep {
namespace {

using Words = std::vector<std::string>;

const CLI::App* subcommand(const CLI::App& app, const std::string& name) {
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    if (sub->get_name() == name) return sub;
  return nullptr;
}

const CLI::Option* option(const CLI::App& verb, const std::string& name) {
  for (const CLI::Option* each : verb.get_options())
    if (each->check_name(name)) return each;
  return nullptr;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

template <class Descriptions>
Words names_of(const Descriptions& all) {
  Words names;
  for (const Description& d : all) names.push_back(d.info.name);
  return names;
}

/// The names that the scene of the line has, read once they are asked for.
class SceneAtHand {
 public:
  SceneAtHand(std::string file, Words plugins) { args_.scene = std::move(file), args_.plugins = std::move(plugins); }

  // "crank=", and what may be varied by its path.
  Words parameters() {
    Words all;
    with_scene([&](const Loaded& loaded) {
      for (const SceneParameter& p : loaded.scene.parameters)
        if (!p.is_point) all.push_back(p.name + "=");
    });
    return all;
  }
  Words channels() {
    Words all;
    with_scene([&](const Loaded& loaded) {
      const Mechanism m = build_mechanism(loaded.scene, loaded.registry);
      for (const ChannelHelp& c : channel_help(m.system))
        if (!c.name.starts_with("ground.")) all.push_back(c.name);
    });
    return all;
  }
  Words things() {
    Words all;
    with_scene([&](const Loaded& loaded) {
      const Mechanism m = build_mechanism(loaded.scene, loaded.registry);
      for (const Body& b : m.system.bodies()) all.push_back(b.name);
      for (const auto& l : m.system.links()) all.push_back(l->name());
      for (const auto& f : m.system.forces()) all.push_back(f->name());
    });
    return all;
  }

 private:
  template <class Use>
  void with_scene(Use&& use) {
    std::error_code error;  // a pipe would wait for somebody to write
    if (!std::filesystem::is_regular_file(args_.scene, error)) return;
    try {
      use(read_with_plugins(args_));
    } catch (...) {  // whoever types a line is not told of a scene that is not ready
    }
  }
  Arguments args_;
};

/// A line as far as it is typed.
struct Line {
  const CLI::App* verb = nullptr;        // the innermost
  const CLI::Option* awaited = nullptr;  // that takes the last word as its value
  Words positionals{}, plugins{};        // before the last word
  std::string last, before;              // "x" and "--solver=" of "--solver=x"
};

Line read_line(const CLI::App& app, const Words& words) {
  Line line{&app, nullptr, {}, {}, words.empty() ? "" : words.back(), ""};
  for (std::size_t k = 0; k + 1 < words.size(); ++k) {
    const std::string& word = words[k];
    if (line.awaited != nullptr) {
      if (line.awaited->check_name("--plugin")) line.plugins.push_back(word);
      line.awaited = nullptr;
    } else if (word.starts_with('-') && word != "-") {
      const CLI::Option* given = option(*line.verb, word);
      if (given != nullptr && takes_value(*given)) line.awaited = given;
    } else if (const CLI::App* sub = subcommand(*line.verb, word)) {
      line.verb = sub;
    } else {
      line.positionals.push_back(word);
    }
  }
  const std::size_t equals = line.last.find('=');
  if (line.awaited == nullptr && line.last.starts_with("--") && equals != std::string::npos) {
    line.awaited = option(*line.verb, line.last.substr(0, equals));
    line.before = line.last.substr(0, equals + 1), line.last.erase(0, equals + 1);
  }
  return line;
}

Words names_on(const Registry& registry, const std::string& option) {
  if (option.starts_with("--integrator")) return names_of(shelf_contents(registry, "integrators"));
  if (option.starts_with("--solver")) return names_of(shelf_contents(registry, "solvers"));
  if (option.starts_with("--formulations")) return formulation_names();
  return {};
}

Completion of_value(const Line& line, const CLI::Option& option, SceneAtHand& scene) {
  const std::string name = "--" + (option.get_lnames().empty() ? option.get_name() : option.get_lnames().front());
  if (const Words all = choices_of(option); !all.empty()) return {all};
  if (name == "--set" || name == "--vary") return {scene.parameters()};
  if (line.verb->get_name() == "check" && name == "--of") return {scene.things()};
  if (name == "--inputs" || name == "--outputs" || name == "--channel") return {scene.channels()};
  if (Words all = names_on(make_registry(line.plugins), name); !all.empty()) return {std::move(all)};
  const std::string type = option.get_type_name();
  return {{}, type.find("FILE") != std::string::npos || type == "DIR" || type == "P"};
}

Completion of_positional(const Line& line, SceneAtHand& scene) {
  std::vector<const CLI::Option*> expected;
  for (const CLI::Option* each : line.verb->get_options())
    if (each->get_positional()) expected.push_back(each);
  if (expected.empty()) return {};
  const CLI::Option& next = *expected[std::min(line.positionals.size(), expected.size() - 1)];
  if (const Words all = choices_of(next); !all.empty()) return {all};
  const std::string verb = line.verb->get_name();
  if (verb == "describe") return {known_words(make_registry(line.plugins))};
  const std::string type = next.get_type_name();
  if (type == "SCENE" || type.find("FILE") != std::string::npos) return {{}, true};
  if (verb == "explain") return {scene.things()};
  return {};
}

Completion all_of(const Line& line, SceneAtHand& scene) {
  if (line.awaited != nullptr) return of_value(line, *line.awaited, scene);
  if (line.last.starts_with('-') && line.last != "-") {
    Completion found;
    for (const CLI::Option* each : line.verb->get_options())
      for (const std::string& name : each->get_lnames()) found.words.push_back("--" + name);
    return found;
  }
  Completion found = of_positional(line, scene);
  if (!line.positionals.empty()) return found;
  for (const CLI::App* sub : line.verb->get_subcommands([](const CLI::App*) { return true; }))
    if (!sub->get_group().empty()) found.words.push_back(sub->get_name());
  return found;
}

constexpr const char* kBash = R"_(# Completion of lockstep for bash: `lockstep completion bash`, in a file that bash reads.
_lockstep() {
  # bash begins a new word after = and :, the program does not: what stands together in the line is one word.
  local line="${COMP_LINE:0:COMP_POINT}" words=() each i
  for ((i = 0; i <= COMP_CWORD; i++)); do
    each="${COMP_WORDS[i]}"
    if ((i > 0)) && [[ "$line" != [[:space:]]* ]]; then words[-1]+="$each"; else words+=("$each"); fi
    line="${line#"${line%%[![:space:]]*}"}"
    line="${line#"$each"}"
  done
  for i in "${!words[@]}"; do  # without quotes
    each="${words[i]//\\/}"
    each="${each#[\"\']}"
    words[i]="${each%[\"\']}"
  done
  local whole="${words[-1]}" word="${COMP_WORDS[COMP_CWORD]}" all
  mapfile -t all < <("${words[0]}" complete "${words[@]:1}" 2>/dev/null)
  COMPREPLY=()
  if [[ "${all[0]-}" == :files ]]; then
    compopt -o filenames 2>/dev/null
    local value="$whole"
    [[ "$value" == --*=* ]] && value="${value#*=}"
    mapfile -t COMPREPLY < <(compgen -f -- "$value")
    all=("${all[@]:1}")
  fi
  local kept=""
  [[ "$whole" == *[=:]* && "$word" != *[=:]?* ]] && kept="${whole%"$word"}"
  [[ "$word" == [=:] ]] && kept="$whole"
  for each in "${all[@]}"; do COMPREPLY+=("${each#"$kept"}"); done
  [[ ${#COMPREPLY[@]} -eq 1 && "${COMPREPLY[0]}" == *= ]] && compopt -o nospace 2>/dev/null
  return 0
}
complete -F _lockstep lockstep
)_";

constexpr const char* kZsh = R"(#compdef lockstep
# Completion of lockstep for zsh: `lockstep completion zsh`, as _lockstep in a folder of $fpath.
_lockstep() {
  local -a all
  all=("${(@f)$("${(Q)words[1]}" complete "${(@Q)words[2,CURRENT]}" 2>/dev/null)}")
  if [[ "${all[1]}" == :files ]]; then
    all=("${(@)all[2,-1]}")
    [[ "$PREFIX" == --*=* ]] && compset -P '*='
    _files
  fi
  local -a open closed
  open=("${(@M)all:#*=}")
  closed=("${(@)all:#*=}")
  closed=("${(@)closed:#}")
  (( ${#open} )) && compadd -S '' -- "${(@)open}"
  (( ${#closed} )) && compadd -- "${(@)closed}"
}
if [[ "$funcstack[1]" == _lockstep ]]; then _lockstep "$@"; else compdef _lockstep lockstep; fi
)";

}  // namespace

Completion completion(const CLI::App& app, const std::vector<std::string>& words) {
  const Line line = read_line(app, words);
  SceneAtHand scene(line.positionals.empty() ? "" : line.positionals.front(), line.plugins);
  Completion found = all_of(line, scene);
  std::erase_if(found.words, [&](const std::string& word) { return !word.starts_with(line.last); });
  std::sort(found.words.begin(), found.words.end());
  found.words.erase(std::unique(found.words.begin(), found.words.end()), found.words.end());
  for (std::string& word : found.words) word = line.before + word;
  return found;
}

std::string completion_script(const std::string& shell) { return shell == "zsh" ? kZsh : kBash; }

int complete_command(const CLI::App& app, int argc, const char* const* argv) {
  const Completion found = completion(app, std::vector<std::string>(argv, argv + argc));
  if (found.files) fmt::print(":files\n");
  for (const std::string& word : found.words) fmt::print("{}\n", word);
  return kExitOk;
}

}  // namespace lockstep
