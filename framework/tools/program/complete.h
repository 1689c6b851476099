// What may follow a line that somebody types: from the verbs and options themselves, the registry, and the scene at hand.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/program/commands.h"

namespace CLI {
class App;
}

namespace lockstep {

/// What the last word of a line may become.
struct Completion {
  std::vector<std::string> words{};
  bool files = false;  ///< file names too
};

/// `words`: those of the line after the program's name; the last may be empty. Nothing is thrown: a scene that cannot
/// be read has no names.
Completion completion(const CLI::App& app, const std::vector<std::string>& words);

/// The script that makes a shell ask for it. `shell`: "bash" or "zsh".
std::string completion_script(const std::string& shell);

/// What these scripts call: `lockstep complete WORDS`. A line a word, first ":files" where file names fit too.
int complete_command(const CLI::App& app, int argc, const char* const* argv);

}  // namespace lockstep
