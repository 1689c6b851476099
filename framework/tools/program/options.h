// SPDX-License-Identifier: BSD-3-Clause
// Commands and their options as data: the line is read, its help printed, completed and documented by these tables.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/tools/program/result.h"

namespace lockstep {

/// An option, or a positional argument.
struct Option {
  std::string_view name;  ///< "--until"; "scene", a positional; "--a,--b": with a second name
  std::string_view type;  ///< what its value is, "TIME", "FILE.csv"; "": a flag; "A,B": names with commas between them
  std::string_view help{};
  std::string_view choices{};            ///< with commas between them; "": anything
  std::string_view needs{}, excludes{};  ///< another option
  bool required = false, repeats = false;
  std::string_view group = "Options";  ///< heading in the help

  /// The same with another value of a member.
  template <class T>
  constexpr Option with(T Option::*member, T value) const {
    Option o = *this;
    o.*member = value;
    return o;
  }
  constexpr bool positional() const { return !name.starts_with('-'); }
  constexpr bool flag() const { return type.empty(); }
  constexpr std::string_view key() const { return name.substr(0, name.find(',')); }
  /// Its help with its choices, and with the option that it needs.
  std::string words() const;
  /// Whether "--a" is one of its names.
  constexpr bool is(std::string_view word) const {
    return word == key() || (name.size() > key().size() && word == name.substr(key().size() + 1));
  }

  // -- the same option with more properties
  constexpr Option among(std::string_view words) const { return with(&Option::choices, words); }
  constexpr Option along(std::string_view other) const { return with(&Option::needs, other); }
  constexpr Option without(std::string_view other) const { return with(&Option::excludes, other); }
  constexpr Option needed() const { return with(&Option::required, true); }
  constexpr Option repeated() const { return with(&Option::repeats, true); }
};

using Options = std::vector<Option>;

/// Several lists as one.
Options join(std::initializer_list<Options> lists);
/// The same options under this heading.
Options grouped(std::string_view heading, Options);

/// A command.
struct Command {
  std::string_view name;  ///< as in tools.h
  Options options;
  Result (*run)(const Arguments&);
  std::string_view footer{};
  std::vector<const Schema*> results{};  ///< what its documents may have (--json)

  /// One of its options; null: it has none of this name.
  const Option* option(std::string_view name) const;
};

// Those of the program `lockstep`.
Command run_command();
Command resume_command();
Command report_command();
Command demo_command();
std::string_view demo_scene();  ///< text of the scene that it shows; the program holds it
Command check_command();
Command list_command();
Command describe_command();
Command schema_command();
Command reference_command();
Command new_plugin_command();
Command completion_command();
Command man_command();
Command plugins_list_command();
std::vector<Command> own_commands();  ///< all of them; the first is run

/// A run, as `run` makes it; it has printed its text.
Result run_scene(const Arguments&);
std::vector<const Schema*> run_results();  ///< what its documents may have

/// The verified digits of a run.
struct CertifiedRun {
  std::string text;   ///< lines
  std::string doubt;  ///< a sentence that names the columns without a verified digit; "" if there are none
};
/// `run`: its settings; `table`: what it recorded.
using Certify = CertifiedRun (*)(const Loaded&, const Arguments&, const RunSettings& run, const Table& table);

/// `run`, and the verified digits after it.
Result run_and_certify(const Arguments&, Certify);

/// The schemas of what commands print with --json, by their names: of these, and of all programs.
Json results_of(std::span<const Command>);
Json results_of_all();

// -- what several commands share
inline constexpr std::string_view kStabilizations = "project,baumgarte,none",
                                  kFormulations = "omega,quaternion,joint,auto";
inline constexpr Option kJson{"--json", "", "print the result as JSON only"};
inline constexpr Option kPlugin =
    Option{"--plugin", "PLUGIN", "load a plugin, by name or path; may be repeated"}.repeated();
inline constexpr Option kHeaders =
    Option{"--headers", "KIND", "column names of the CSV file: units (default), as in \"x [m]\", or plain, as in \"x\""}
        .among("units,plain");
inline constexpr Option kPicture =
    Option{"--picture", "X:Y", "one more picture: column Y against column X (the path of a point); may be repeated"}
        .repeated();
inline constexpr Option kNoPicture{"--no-picture", "", "draw no picture"};
inline constexpr Option kJobs{"--jobs", "N", "threads, 1 to 1024; default: the available processors"};
Options scene_options();     ///< the scene, and what changes it
Options settings_options();  ///< the scene, and how it is run
Options run_options();       ///< all that `run` takes
Options run_outputs();       ///< of those, what a run writes except its report

}  // namespace lockstep
