// SPDX-License-Identifier: BSD-3-Clause
// The command line: from words to a command, and the exit codes of errors.
#include "framework/tools/program/commands.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/logger.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include <lockstep/log.h>
#include <lockstep/text.h>
#include <lockstep/version.h>
#include "framework/description/scene/json.h"
#include "framework/foundation/support/lines.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/program/tools.h"

namespace lockstep {
namespace {

// A word of the command line without the folders of a file that it names.
std::string without_folders(std::string word, const Arguments& args) {
  std::vector<std::string> files = args.all("--plugin");
  for (const char* name : {"scene", "file", "--record", "--report", "--out", "--histories", "--csv"})
    files.push_back(args[name]);
  for (const std::string& file : files)
    if (const std::size_t slash = file.find_last_of('/'); slash != std::string::npos && word.ends_with(file))
      return word.erase(word.size() - file.size(), slash + 1);
  return word;
}

// The help of an option without the notation of the parser: "--set NAME=VALUE ...".
class HelpFormat final : public CLI::Formatter {
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    return CLI::detail::find_and_replace(Formatter::make_help(app, std::move(name), mode), "\n\n\n", "\n\n");
  }
  std::string make_option_opts(const CLI::Option* o) const override {
    const bool many = o->get_expected_max() == CLI::detail::expected_max_vector_size;
    return (o->get_type_name().empty() ? "" : " " + o->get_type_name()) + (many ? " ..." : "") +
           (o->get_required() && o->nonpositional() ? " (required)" : "");
  }
};

void add_option(CLI::App& app, const Option& o, std::map<std::string, CLI::Option*, std::less<>>& known) {
  const std::string name(o.name);
  const bool names = o.type == "A,B";
  CLI::Option* option = nullptr;
  if (o.flag()) {
    option = app.add_flag(name)->check(CLI::TypeValidator<bool>(""));
  } else {
    option = app.add_option(name)->type_name(std::string(o.type))->expected(1);
    if (o.repeats || names)
      option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(o.positional());
    if (names) option->delimiter(',');
    if (!o.choices.empty()) option->check(CLI::IsMember(lines_of(o.choices, ',')).description(""));
  }
  option->required(o.required)->group(std::string(o.group));
  std::vector<std::string> excluded = lines_of(o.excludes, ',');
  std::erase_if(excluded, [&](const std::string& other) { return !known.contains(other); });
  for (const std::string& other : excluded) option->excludes(known.at(other));
  option->description(o.words() + (excluded.empty() ? "" : " (not with " + text::join(excluded, " or ") + ")"));
  if (!o.needs.empty()) option->needs(known.find(o.needs)->second);
  known.emplace(o.key(), option);
}

// A command with its options: the app "list" below "plugins" for "plugins list".
CLI::App& add_command(CLI::App& app, const Command& command) {
  const Verb& verb = *verb_of(command.name);
  const std::string group(verb.group);
  CLI::App* parent = &app;
  std::string name(command.name);
  if (const std::size_t blank = name.find(' '); blank != std::string::npos) {
    const std::string first = name.substr(0, blank);
    const auto there = app.get_subcommands([&](const CLI::App* sub) { return sub->get_name() == first; });
    if (!there.empty())
      parent = there.front();
    else
      parent = app.add_subcommand(first, "List plugins")->require_subcommand(1);
    parent->group(group);
    name.erase(0, blank + 1);
  }
  CLI::App& sub = *parent->add_subcommand(name, std::string(verb.help))->group(group);
  std::map<std::string, CLI::Option*, std::less<>> known;
  for (const Option& o : command.options) add_option(sub, o, known);
  sub.footer(std::string(command.footer));
  return sub;
}

Arguments arguments_of(const CLI::App& sub, const Command& command, int argc, const char* const* argv) {
  Arguments args;
  for (const Option& o : command.options) {
    const CLI::Option* option = sub.get_option(std::string(o.key()));
    if (option->count() == 0 || (o.flag() && !option->as<bool>())) continue;
    args.set(o.key(), option->results());
  }
  args.words.assign(argv + 1, argv + argc);
  args.command = "lockstep";  // and its words, the same on every machine: "lockstep run four_bar.json --until 3"
  for (const std::string& word : args.words) args.command += " " + in_quotes(without_folders(word, args));
  return args;
}

// Prints what is wrong with the command line, the closest name that exists, and how to get help.
int print_usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> called = app.get_subcommands();
  const CLI::App& verb = called.empty() ? app : *called.front();
  const std::vector<std::string> unknown = app.remaining(true);
  const std::string word = unknown.empty() ? "" : unknown.front();
  std::vector<std::string> verbs, options;
  for (const CLI::App* v : app.get_subcommands([](const CLI::App*) { return true; })) verbs.push_back(v->get_name());
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);

  std::string text = error.what();
  const std::string name = word.substr(0, word.find('='));
  if (const std::size_t at = text.find(" not in {"), colon = text.find(": "); at < text.size() && colon < at) {
    const std::string given = text.substr(colon + 2, at - colon - 2), choices = text.substr(at + 9);
    text = text.substr(0, colon) + ": unknown \"" + given + "\"" +
           text::suggestion(given, lines_of(choices.substr(0, choices.size() - 1), ','));
  }
  std::vector<std::string> bare;  // for a synonym: "dt" means "step"
  for (const std::string& option : options) bare.push_back(option.substr(2));
  const std::string meant = name.starts_with("--") ? text::closest_name(name.substr(2), bare) : "";
  if (!called.empty() && std::ranges::find(options, name) != options.end())
    text = "option " + name + " must follow the command: lockstep " + verb.get_name() + " ... " + name;
  else if (word.rfind('-', 0) == 0)
    text = "unknown option \"" + word + "\"" +
           (meant.empty() ? text::suggestion(name, options) : "; did you mean \"--" + meant + "\"?");
  else if (called.empty())
    text = word.empty() ? "a command is missing; known: " + text::join(verbs, ", ")
                        : "unknown command \"" + word + "\"" + text::suggestion(word, verbs);
  else if (!word.empty())
    text = "unexpected word \"" + word + "\"; text with blanks needs quotes";
  const std::string of = called.empty() ? "" : verb.get_name() + " ";
  tell(fmt::format("{} {}\nSee `lockstep {}--help`.\n", error_mark(), text, of));
  return kExitUsage;
}

// Without a further request for memory.
int out_of_memory() {
  tell("error: out of memory; record less (output, record), or run fewer instances at once\n");
  return kExitMemory;
}

// If a destructor needs memory while an error of memory is on its way (those of JSON objects do), C++ calls
// std::terminate: words and exit code are those of any other request that fails. Anything else that ends so is a bug,
// and leaves its core.
std::terminate_handler usual_end = nullptr;
[[noreturn]] void end_without_memory() {
  if (std::current_exception()) {
    try {
      throw;
    } catch (const std::bad_alloc&) {
      std::_Exit(out_of_memory());
    } catch (...) {
    }
  }
  if (usual_end != nullptr) usual_end();
  std::abort();
}

int guarded(const std::function<int()>& command) {
  try {
    return command();
  } catch (const Error& error) {
    tell(text_of(CommandFindings::added()));
    tell_error(in_lines(error));
    return exit_code_of(error);
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  } catch (...) {
    tell_error(thrown_words(std::current_exception()));
    return kExitFailure;
  }
}

// The bare numbers of --set and --vary: an error of the scene may follow from a unit that is missing.
std::string bare_numbers(const Arguments& args) {
  const bool is_file = !args["scene"].empty() && args["scene"] != "-";
  const Value scene = is_file ? read_json_file(scene_or_sample(args["scene"])) : Value();
  const Value* parameters = scene.find("parameters");
  std::vector<std::string> all;
  for (const char* option : {"--set", "--vary"})
    for (const std::string& word : args.all(option)) {
      const std::size_t equals = word.find('=');
      if (word.find_first_not_of("0123456789.,:+-e ", equals + 1) != std::string::npos) continue;
      const Value* written = parameters != nullptr ? parameters->find(word.substr(0, equals)) : nullptr;
      const bool has_text = written != nullptr && written->text() != nullptr;
      all.push_back(word + (has_text ? " (" + *written->text() + " in the file)" : ""));
    }
  return all.empty() ? "" : "\n  with " + text::join(all) + " from the command line, in SI units";
}

Result run_explained(const Command& command, const Arguments& args) try {
  return command.run(args);
} catch (const SceneError& error) {
  const std::string said = error.what();
  std::string more = error.line == 0 ? "" : bare_numbers(args);
  for (const std::string unknown : {"unknown type \"", "unknown law \""})
    if (const std::size_t at = said.find(unknown), from = at + unknown.size(); at != std::string::npos)
      if (const std::string advice = plugin_advice(said.substr(from, said.find('"', from) - from)); !advice.empty())
        more += "\n  " + advice.substr(2);
  if (more.empty()) throw;
  throw SceneError(said + more, error.data());
}

int run_words(const Program& program, int argc, const char* const* argv) {
  if (program.calls_tools)
    if (const std::optional<int> code = call_tool(argc, argv)) return *code;
  if (argc > 1 && std::string_view(argv[1]) == "complete")
    return guarded([&] { return print_completions(program, argc - 2, argv + 2); });
  if (const std::string_view asked = argc == 2 && !program.calls_tools ? argv[1] : "";
      asked == "man-verbs" || asked == "results") {
    fmt::print("{}", asked == "results" ? results_of(program.commands).dump() + "\n" : commands_page(program));
    return kExitOk;
  }
  if (argc == 3 && std::string_view(argv[1]) == "plugin-answer")
    return guarded([&] { return answer_for_plugin(argv[2]); });
  CLI::App app("lockstep: simulates mechanisms of rigid bodies with the lock formulation", "lockstep");
  app.formatter(std::make_shared<HelpFormat>());
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.set_version_flag("--version", fmt::format("lockstep {}{}{}{}", kVersion, commit_of_build().empty() ? "" : " (",
                                                commit_of_build(), commit_of_build().empty() ? "" : ")"));
  app.require_subcommand(1);
  std::string first = "Example:\n  lockstep run samples/scenes/four_bar.json\nOptions: lockstep COMMAND --help\n";
  if (const std::string scenes = shared_folder("lockstep/scenes"); !scenes.empty())
    first += "Sample scenes: " + scenes + "\n";
  if (const std::string pages = shared_folder("doc/lockstep/framework/docs"); !pages.empty())
    first += "Pages: " + pages + "; begin with first_steps.md\n";
  app.footer(first + "\nExit codes:\n" + kExitCodes);
  std::vector<std::pair<const CLI::App*, const Command*>> commands;
  for (const Verb& verb : verbs()) {
    const auto own = std::ranges::find(program.commands, verb.name, &Command::name);
    if (own != program.commands.end())
      commands.emplace_back(&add_command(app, *own), &*own);
    else if (program.calls_tools)
      app.add_subcommand(std::string(verb.name), std::string(verb.help))
          ->group(std::string(verb.group))
          ->prefix_command();
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : print_usage_error(app, error);
  }
  const auto& chosen = *std::ranges::find_if(commands, [](const auto& c) { return c.first->parsed(); });
  const CommandFindings found;
  return guarded([&] {
    const Arguments args = arguments_of(*chosen.first, *chosen.second, argc, argv);
    if (args.has("--json") && args["--record"] == "-")
      throw UsageError("--json: standard output takes the table (--record -); write one of the two to a file");
    Result result = run_explained(*chosen.second, args);
    result.command = args.command;
    print(result, args);
    return result.code;
  });
}

// The exit code of what was printed, which may be waiting in memory still.
int printed(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  tell("error: standard output cannot be written; the printed text is incomplete\n");
  return code == kExitOk || code == kExitFailure ? kExitFile : code;  // a failed write may have ended the command
}

}  // namespace

int exit_code_of(const Error& error) {
  using Kind = Error::Kind;
  static const std::map<Kind, Exit> kCodes{{Kind::usage, kExitUsage},
                                           {Kind::scene, kExitScene},
                                           {Kind::model, kExitScene},
                                           {Kind::plugin, kExitPlugin},
                                           {Kind::user_code, kExitPlugin},
                                           {Kind::assembly, kExitAssembly},
                                           {Kind::step, kExitStep},
                                           {Kind::solve, kExitStep},
                                           {Kind::non_finite, kExitNonFinite},
                                           {Kind::file, kExitFile},
                                           {Kind::interrupted, kExitInterrupted}};
  const auto code = kCodes.find(error.kind());
  return code == kCodes.end() ? kExitFailure : code->second;
}

const std::string& Arguments::operator[](std::string_view name) const {
  static const std::string kNone;
  const auto found = values_.find(name);
  return found == values_.end() || found->second.empty() ? kNone : found->second.front();
}
const std::vector<std::string>& Arguments::all(std::string_view name) const {
  static const std::vector<std::string> kNone;
  const auto found = values_.find(name);
  return found == values_.end() ? kNone : found->second;
}
void Arguments::set(std::string_view name, std::vector<std::string> values) {
  values_.insert_or_assign(std::string(name), std::move(values));
}

Arguments read_run_words(const std::vector<std::string>& words) {
  CLI::App app("lockstep", "lockstep");
  const Command run = own_commands().front();
  const CLI::App& sub = add_command(app, run);
  std::vector<const char*> argv{"lockstep"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  const int argc = static_cast<int>(argv.size());
  try {
    app.parse(argc, argv.data());
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string("the command line in the checkpoint cannot be read: ") + error.what());
  }
  return arguments_of(sub, run, argc, argv.data());
}

int run_program(std::vector<Command> (*commands)(), bool calls_tools, int argc, const char* const* argv) {
  usual_end = std::set_terminate(end_without_memory);
  logger()->set_pattern("%l: %v");
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit (ulimit -f) is a write that fails
  try {
    const std::vector<Command> made = commands();
    std::vector<const char*> words(argv, argv + argc);
    if (argc > 1 && std::string_view(argv[1]) == "plugins" && (argc == 2 || argv[2][0] == '-'))
      words.insert(words.begin() + 2, "list");
    if (argc > 1 && std::string_view(argv[1]) == "help") words.erase(words.begin() + 1), words.push_back("--help");
    return printed(run_words({made, calls_tools}, static_cast<int>(words.size()), words.data()));
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  }
}

}  // namespace lockstep
