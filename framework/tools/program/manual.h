// The manual page of the program, written from its verbs and options.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace lockstep {

/// lockstep(1), in the macros of man(7).
std::string manual_page(const CLI::App& app);
/// Its part on the verbs of a program.
std::string verbs_page(const CLI::App& app);

}  // namespace lockstep
