#include "framework/tools/program/manual.h"

#include <CLI/CLI.hpp>
#include <sstream>

#include <lockstep/text.h>
#include <lockstep/version.h>
#include "framework/tools/program/options.h"
#include "framework/tools/program/tools.h"

namespace lockstep {
namespace {

// Text of a page: nothing in it is a command of roff, and a hyphen stays one.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += std::string("\\&") + c;
    else
      out += c;
  }
  return out;
}

// Lines as they stand.
std::string verbatim(const std::string& text) { return ".nf\n" + escaped(text) + "\n.fi\n"; }

// "--step H", "-h, --help", "SCENE".
std::string form_of(const CLI::Option& option) {
  const std::string type = value_of(option);
  if (option.get_positional()) return "\\fI" + escaped(type) + "\\fR";
  std::string names;
  for (const std::string& name : option.get_snames()) names += "\\fB" + escaped("-" + name) + "\\fR, ";
  for (const std::string& name : option.get_lnames()) names += "\\fB" + escaped("--" + name) + "\\fR, ";
  names.resize(names.size() - 2);
  return option.get_items_expected_max() > 0 ? names + " \\fI" + escaped(type) + "\\fR" : names;
}

std::string choices_text(const CLI::Option& option) {
  const Choices all = choices_of(option);
  return all.empty() ? "" : " (" + text::join(all) + ")";
}

void write_verb(std::ostringstream& out, const CLI::App& verb, const std::string& name) {
  out << ".SS \"lockstep " << escaped(name);
  for (const CLI::Option* option : verb.get_options())
    if (option->get_positional())
      out << " " << (option->get_required() ? "" : "[") << escaped(value_of(*option))
          << (option->get_required() ? "" : "]");
  out << "\"\n" << escaped(verb.get_description()) << ".\n";
  for (const CLI::Option* option : verb.get_options())
    if (!option->check_name("--help"))
      out << ".TP\n" << form_of(*option) << "\n" << escaped(option->get_description() + choices_text(*option)) << "\n";
  if (!verb.get_footer().empty()) out << ".PP\n" << verbatim(verb.get_footer());
}

void write_verbs(std::ostringstream& out, const CLI::App& app, const std::string& before) {
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_group().empty() || verb->get_prefix_command()) continue;  // of tools: theirs
    const std::string name = before + verb->get_name();
    const bool has_own = !verb->get_subcommands([](const CLI::App*) { return true; }).empty();
    if (has_own)
      write_verbs(out, *verb, name + " ");
    else
      write_verb(out, *verb, name);
  }
}

constexpr const char* kEnvironment = R"(.SH ENVIRONMENT
.TP
.B LOCKSTEP_OUTPUT
the folder of results that are not named; default: the present one
.TP
.B LOCKSTEP_EXEC_PATH
the folder of the programs that lockstep calls; default: libexec/lockstep beside its own folder
.TP
.B LOCKSTEP_PLUGIN_PATH
folders with plugins, separated by colons, before the program's own
.TP
.B NO_COLOR
if set, messages have no colour
.SH FILES
.TP
.I NAME.csv.partial
rows of a run that has not ended, or that ended with an error
.TP
.I NAME.csv.sweep
what a sweep that has not ended was begun by, for sweep \-\-resume
)";

}  // namespace

std::string verbs_page(const CLI::App& app) {
  std::ostringstream out;
  write_verbs(out, app, "");
  return out.str();
}

std::string manual_page(const CLI::App& app) {
  std::ostringstream out;
  out << ".TH LOCKSTEP 1 \"\" \"lockstep " << kVersion << "\" \"User Commands\"\n"
      << ".SH NAME\nlockstep \\- simulate mechanisms of rigid bodies\n"
      << ".SH SYNOPSIS\n.B lockstep\n.I VERB\n.RI [ OPTIONS ]\n"
      << ".SH DESCRIPTION\nlockstep reads a mechanism of rigid bodies, joints, laws of motion and forces from a scene, "
         "a "
         "file in JSON, and computes its motion: as a table, as pictures, and as one page for the browser that shows "
         "it "
         "move.\n"
      << ".PP\nBegin with\n.B lockstep demo\nor\n.BR \"lockstep describe scene\" .\n"
      << ".SH VERBS\n";
  out << verbs_page(app) << pages_of_tools();
  const std::string footer = app.get_footer();
  const std::size_t codes = footer.find("Exit codes: ");
  out << ".SH EXIT STATUS\n" << escaped(codes == std::string::npos ? footer : footer.substr(codes + 12)) << ".\n";
  return out.str() + kEnvironment;
}

}  // namespace lockstep
