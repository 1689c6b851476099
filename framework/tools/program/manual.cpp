// SPDX-License-Identifier: BSD-3-Clause
// The manual page of the program, written from its commands and options.
#include <spdlog/fmt/fmt.h>

#include <boost/algorithm/string/replace.hpp>
#include <regex>
#include <sstream>

#include <lockstep/version.h>
#include "framework/foundation/support/lines.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/tools.h"

namespace lockstep {
namespace {

// Text of a page: nothing in it is a command of roff, and a hyphen stays one.
std::string escaped(std::string_view text) {
  std::string out = boost::replace_all_copy(std::string(text), "\\", "\\e");
  boost::replace_all(out, "-", "\\-");
  return std::regex_replace(out, std::regex("(^|\n)([.'])"), R"($1\&$2)");
}

// Lines as they are.
std::string verbatim(std::string_view text) { return ".nf\n" + escaped(text) + "\n.fi\n"; }

// "--step H", "SCENE".
std::string form_of(const Option& option) {
  const std::string type = "\\fI" + escaped(option.type) + "\\fR";
  if (option.positional()) return type;
  std::string names;
  for (const std::string& name : lines_of(option.name, ','))
    names += (names.empty() ? "" : ", ") + ("\\fB" + escaped(name) + "\\fR");
  return option.flag() ? names : names + " " + type;
}

void write_command(std::ostringstream& out, const Command& command) {
  out << ".SS \"lockstep " << escaped(command.name);
  for (const Option& o : command.options)
    if (o.positional()) out << (o.required ? " " : " [") << escaped(o.type) << (o.required ? "" : "]");
  out << "\"\n" << escaped(verb_of(command.name)->help) << ".\n";
  for (const Option& o : command.options) out << ".TP\n" << form_of(o) << "\n" << escaped(o.words()) << "\n";
  if (!command.footer.empty()) out << ".PP\n" << verbatim(command.footer);
}

constexpr const char* kEnvironment = R"(.SH ENVIRONMENT
.TP
.B LOCKSTEP_OUTPUT
the folder of results without a name; default: the current folder
.TP
.B LOCKSTEP_EXEC_PATH
the folder of the programs that lockstep calls; default: libexec/lockstep next to its own folder
.TP
.B LOCKSTEP_PLUGIN_PATH
folders with plugins, separated by colons, before the program's own
.TP
.B NO_COLOR
if set, messages have no colour
.SH FILES
.TP
.I NAME.csv
the recorded columns of a run
.TP
.I NAME.csv.partial
rows of a run that has not ended, or that ended with an error
.TP
.I NAME.csv.sweep
the command of an unfinished sweep, for sweep \-\-resume
)";

Result print_manual(const Arguments&) {
  std::ostringstream out;
  out << ".TH LOCKSTEP 1 \"\" \"lockstep " << kVersion << "\" \"User Commands\"\n"
      << ".SH NAME\nlockstep \\- simulate mechanisms of rigid bodies\n"
      << ".SH SYNOPSIS\n.B lockstep\n.I COMMAND\n.RI [ OPTIONS ]\n"
      << ".SH DESCRIPTION\nlockstep reads a mechanism of rigid bodies, joints, laws of motion and forces from a "
         "scene, a file in JSON. It writes the motion as a table, as pictures, and as one animated page for the "
         "browser.\n"
      << ".PP\nBegin with\n.B lockstep demo\nor\n.BR \"lockstep describe scene\" .\n"
      << ".SH COMMANDS\n";
  out << commands_page({own_commands(), true}) << ask_tools("man-verbs") << ".SH EXIT STATUS\n" << verbatim(kExitCodes);
  fmt::print("{}{}", out.str(), kEnvironment);
  return kExitOk;
}

}  // namespace

std::string commands_page(const Program& program) {
  std::ostringstream out;
  for (const Command& command : program.commands)
    if (verb_of(command.name)->program.empty() == program.calls_tools) write_command(out, command);
  return out.str();
}

Command man_command() { return {"man", {}, print_manual, "Example:\n  lockstep man | man -l -"}; }

}  // namespace lockstep
