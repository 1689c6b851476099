// SPDX-License-Identifier: BSD-3-Clause
// Completions of a typed line: from the commands and options themselves, the registry, and the scene at hand.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include <lockstep/author/lock.h>
#include <lockstep/finding.h>
#include <lockstep/recorder.h>
#include "framework/description/scene/describe.h"
#include "framework/foundation/support/lines.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/tools.h"

namespace lockstep {
namespace {

using Words = std::vector<std::string>;

/// The completions of the last word of a line.
struct Completion {
  Words words{};
  bool files = false;  ///< file names too
};

/// The names that the scene of the line has, read once they are asked for.
class SceneAtHand {
 public:
  SceneAtHand(std::string file, Words plugins) {
    args_.set("scene", std::move(file)), args_.set("--plugin", std::move(plugins));
  }

  // "crank=".
  Words parameters() {
    return of_scene([](const Loaded& loaded, Words& all) {
      for (const SceneParameter& p : loaded.scene.parameters)
        if (!p.is_point) all.push_back(p.name + "=");
    });
  }
  Words channels() {
    return of_system([](const System& system, Words& all) {
      for (const ChannelHelp& c : channel_help(system))
        if (!c.name.starts_with("ground.")) all.push_back(c.name);
    });
  }
  Words inputs() {
    return of_system([](const System& system, Words& all) {
      for (const auto& l : system.links())
        if (const Jointed* joint = l->jointed())
          for (const Drive& drive : joint->imposed().drives)
            all.push_back(l->name() + "." + std::string(to_string(drive.axis)));
      for (const auto& f : system.forces()) all.push_back(f->name());
    });
  }
  Words things() {
    return of_system([](const System& system, Words& all) {
      for (const Body& b : system.bodies()) all.push_back(b.name);
      for (const auto& l : system.links()) all.push_back(l->name());
      for (const auto& f : system.forces()) all.push_back(f->name());
    });
  }

 private:
  template <class Collect>
  Words of_scene(Collect&& collect) {
    Words all;
    std::error_code error;  // reading a pipe would block
    if (!std::filesystem::is_regular_file(args_["scene"], error)) return all;
    thrown_by([&] { collect(read_with_plugins(args_), all); });  // an unfinished scene is no error
    return all;
  }
  template <class Collect>
  Words of_system(Collect&& collect) {
    return of_scene(
        [&](const Loaded& loaded, Words& all) { collect(build_mechanism(loaded.scene, loaded.registry).system, all); });
  }
  Arguments args_;
};

/// A line as far as it is typed.
struct Line {
  const Program& program;
  std::string said{};                // the first words of a command's name: "plugins"
  const Command* command = nullptr;  // null: not yet
  const Option* awaited = nullptr;   // that takes the last word as its value
  Words positionals{}, plugins{};    // before the last word
  std::string last, before{};        // "x" and "--solver=" of "--solver=x"

  const Option* option(std::string_view name) const { return command != nullptr ? command->option(name) : nullptr; }
  // What follows `said` in the names of commands.
  Words commands() const {
    Words all;
    const auto take = [&](std::string_view name) {
      if (!name.starts_with(said)) return;
      name.remove_prefix(said.size());
      all.emplace_back(name.substr(0, name.find(' ')));
    };
    for (const Command& c : program.commands) take(c.name);
    if (program.calls_tools)
      for (const Verb& verb : verbs()) take(verb.name);
    return all;
  }
  void name(const std::string& word) {
    const auto found = std::ranges::find(program.commands, said + word, &Command::name);
    if (found != program.commands.end())
      command = &*found;
    else if (const Words all = commands(); std::ranges::find(all, word) != all.end())
      said += word + " ";
    else
      positionals.push_back(word);
  }
};

Line read_line(const Program& program, const Words& words) {
  Line line{program, "", nullptr, nullptr, {}, {}, words.empty() ? "" : words.back()};
  for (std::size_t k = 0; k + 1 < words.size(); ++k) {
    const std::string& word = words[k];
    if (line.awaited != nullptr) {
      if (line.awaited->is("--plugin")) line.plugins.push_back(word);
      line.awaited = nullptr;
    } else if (word.starts_with('-') && word != "-") {
      const Option* given = line.option(word);
      if (given != nullptr && !given->flag()) line.awaited = given;
    } else if (line.command == nullptr) {
      line.name(word);
    } else {
      line.positionals.push_back(word);
    }
  }
  const std::size_t equals = line.last.find('=');
  if (line.awaited == nullptr && line.last.starts_with("--") && equals != std::string::npos) {
    line.awaited = line.option(line.last.substr(0, equals));
    line.before = line.last.substr(0, equals + 1), line.last.erase(0, equals + 1);
  }
  return line;
}

Words names_on(const Registry& registry, const std::string& option) {
  Words names;
  for (const char* shelf : {"integrators", "solvers"})  // --integrator, --integrators
    if (("--" + std::string(shelf)).starts_with(option))
      for (const Description& d : shelf_contents(registry, shelf)) names.push_back(d.info.name);
  return names;
}

Completion of_value(const Line& line, const Option& option, SceneAtHand& scene) {
  const std::string name(option.key());
  if (!option.choices.empty()) return {lines_of(option.choices, ',')};
  if (name == "--set" || name == "--vary") return {scene.parameters()};
  if (line.command->name == "check" && name == "--of") return {scene.things()};
  if (name == "--inputs") return {scene.inputs()};
  if (name == "--outputs") return {scene.channels()};
  if (Words all = names_on(make_registry(line.plugins), name); !all.empty()) return {std::move(all)};
  return {{}, option.type.find("FILE") != option.type.npos || option.type == "DIR" || option.is("--plugin")};
}

Completion of_positional(const Line& line, SceneAtHand& scene) {
  std::vector<const Option*> expected;
  for (const Option& each : line.command->options)
    if (each.positional()) expected.push_back(&each);
  if (expected.empty()) return {};
  const Option& next = *expected[std::min(line.positionals.size(), expected.size() - 1)];
  if (!next.choices.empty()) return {lines_of(next.choices, ',')};
  if (line.command->name == "describe") {
    Words all = known_words(make_registry(line.plugins));
    for (const FindingKind* kind : finding_kinds()) all.emplace_back(kind->code);
    return {std::move(all)};
  }
  if (next.type == "SCENE" || next.type.find("FILE") != next.type.npos) return {{}, true};
  if (line.command->name == "explain") {
    Words all = scene.things();
    std::erase(all, "ground");
    return {std::move(all)};
  }
  return {};
}

Completion all_of(const Line& line, SceneAtHand& scene) {
  if (line.awaited != nullptr) return of_value(line, *line.awaited, scene);
  if (line.last.starts_with('-') && line.last != "-") {
    Completion found{{"--help"}};
    if (line.command == nullptr) found.words.emplace_back("--version");
    if (line.command != nullptr)
      for (const Option& each : line.command->options)
        if (!each.positional())
          for (const std::string& name : lines_of(each.name, ',')) found.words.push_back(name);
    return found;
  }
  if (line.command != nullptr) return of_positional(line, scene);
  return line.positionals.empty() ? Completion{line.commands()} : Completion{};
}

constexpr const char* kBash =
    R"_(# Completion of lockstep for bash: `lockstep completion bash`, in a file that bash reads.
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

Command completion_command() {
  return {"completion",
          {Option{"shell", "SHELL", "the shell"}.among("bash,zsh").needed()},
          [](const Arguments& args) -> Result {
            fmt::print("{}", args["shell"] == "zsh" ? kZsh : kBash);
            return kExitOk;
          },
          "Example:\n  lockstep completion bash > ~/.local/share/bash-completion/completions/lockstep"};
}

int print_completions(const Program& program, int argc, const char* const* argv) {
  const Line line = read_line(program, Words(argv, argv + argc));
  SceneAtHand scene(line.positionals.empty() ? "" : line.positionals.front(), line.plugins);
  const Completion found = all_of(line, scene);
  if (found.files) fmt::print(":files\n");
  for (const std::string& word : std::set<std::string>(found.words.begin(), found.words.end()))
    if (word.starts_with(line.last)) fmt::print("{}{}\n", line.before, word);
  return kExitOk;
}

}  // namespace lockstep
