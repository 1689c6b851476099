// SPDX-License-Identifier: BSD-3-Clause
// What all programs share: arguments, scenes with their plugins, exit codes.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>

namespace lockstep {

/// The exit codes of the program.
enum Exit {
  kExitOk = 0,
  kExitFailure = 1,  ///< anything without a code of its own
  kExitUsage = 2,
  kExitScene = 3,
  kExitPlugin = 4,
  kExitAssembly = 5,
  kExitStep = 6,
  kExitNonFinite = 7,
  kExitFile = 8,
  kExitNotConserved = 9,  ///< the run is complete; its energy error or constraint violation is beyond the limit
  kExitMemory = 10,
  /// The run is complete, and its result is doubtful: with --strict by exit_code_of (findings.h), with --certify by a
  /// column without a verified digit.
  kExitDoubtful = 11,
  kExitInterrupted = 130
};

/// The exit codes, for `lockstep --help` and the manual.
inline constexpr const char* kExitCodes =
    "    0  done\n"
    "    1  any other failure\n"
    "    2  invalid command line\n"
    "    3  invalid scene\n"
    "    4  a plugin, or its code\n"
    "    5  the start, or a jump of a law, does not fit the constraints\n"
    "    6  a step or solution cannot be computed\n"
    "    7  a number is not finite\n"
    "    8  a file that cannot be read or written\n"
    "    9  complete; energy error or constraint violation beyond its limit (energy_limit, violation_limit)\n"
    "   10  out of memory\n"
    "   11  complete; doubtful result (--strict, --certify), or start far from the one given (assemble)\n"
    "  130  interrupted";

/// An invalid command line.
class UsageError : public Error {
 public:
  using Error::Error;
  Kind kind() const noexcept override { return Kind::usage; }
};

/// Reads the value of an option, whose errors become those of the command line, unless they have a line of the scene: the
/// value can be read then.
template <class Read>
auto as_usage(const std::string& option, Read&& read) {
  try {
    return read();
  } catch (const ModelError& error) {
    throw UsageError(option + ": " + error.what());
  } catch (const SceneError& error) {
    if (error.line != 0) throw;
    throw UsageError(option + ": " + error.what());
  }
}

/// What the command line gives: values by the names of their options, as text.
class Arguments {
 public:
  /// The value of an option or positional; "" if it is not given.
  const std::string& operator[](std::string_view name) const;
  bool has(std::string_view name) const { return values_.contains(name); }  ///< whether it is given
  /// The values of one that repeats, or takes several names.
  const std::vector<std::string>& all(std::string_view name) const;
  void set(std::string_view name, std::vector<std::string> values);                                 ///< gives one
  void set(std::string_view name, std::string value) { set(name, std::vector{std::move(value)}); }  ///< the same

  std::string command{};             ///< the whole command line, files by their names alone
  std::vector<std::string> words{};  ///< of the command line, after the program's name

 private:
  std::map<std::string, std::vector<std::string>, std::less<>> values_;
};

/// A scene with the plugins that it and the command line ask for.
struct Loaded {
  Registry registry;
  Scene scene;

  /// The scene's title, or its file if it has none.
  const std::string& title() const { return scene.title.empty() ? scene.file : scene.title; }
};

/// Built-in types and those of plugins: first of those that the command line gives by name or path, then of those that
/// a scene requires by name, unless the command line gave a file of that name.
Registry make_registry(const std::vector<std::string>& plugins, const std::vector<std::string>& required = {});
/// Reads the scene and loads plugins; the run settings are the scene's own.
Loaded read_with_plugins(const Arguments&);
/// Replaces run settings of the scene by those of the command line. Throws UsageError.
void override_settings(RunSettings&, const Arguments&, const Registry&);
/// Reads the scene, loads plugins and overrides the run settings.
Loaded load(const Arguments&);

/// The command line of an earlier run, `lockstep run` ..., by its words after the program's name.
Arguments read_run_words(const std::vector<std::string>& words);

/// The commit that the program was built from, if the tree was clean; else "".
std::string_view commit_of_build();

/// The code for an error.
int exit_code_of(const Error&);

/// A hidden command: answers `plugins list` about one file, whose code may end this process.
int answer_for_plugin(const char* file);
/// The advice to load the installed plugin that brings this type; "" if none does.
std::string plugin_advice(const std::string& type);

struct Command;

/// The commands of a program, and whether it is lockstep itself, which finds the others (tools.h).
struct Program {
  std::span<const Command> commands;
  bool calls_tools = false;
};

/// Called by shells: `lockstep complete WORDS`, the words after the program's name, the last of them perhaps empty. Prints
/// a line per completion, first ":files" if file names fit too. A scene that cannot be read has no names.
int print_completions(const Program&, int argc, const char* const* argv);
/// The part of the manual page on the commands of a program, without one that replaces a command of lockstep.
std::string commands_page(const Program&);
/// Reads the command line, runs a command, prints errors on standard error. Returns an Exit.
int run_program(std::vector<Command> (*commands)(), bool calls_tools, int argc, const char* const* argv);

}  // namespace lockstep
