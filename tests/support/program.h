// SPDX-License-Identifier: BSD-3-Clause
// The program, called as a person calls it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace lockstep::testing {

/// Where the calls work and write: a folder of the build tree.
extern const std::string kRunnerFolder;

struct Called {
  int exit = -1;     ///< 128 + signal when one ended it
  std::string text;  ///< both streams
};

/// `words` follow the program's name on a line of the shell, `before` stands before it.
Called call(const std::string& words, const std::string& before = {});
/// A whole line of the shell, the program on its PATH.
Called shell(const std::string& line);
/// What was called ended by this exit code, and its text has these words.
void check_refused(const Called& called, int exit, const std::vector<std::string>& words);

/// Writes a scene of these members into the folder; its path.
std::string scene_file(const std::string& name, const std::string& members);

/// The path of a sample scene, in quotes.
std::string sample(const std::string& name);
/// What a call that succeeds prints as JSON.
nlohmann::json json_of(const std::string& words);
/// The path of the sample scene four_bar.json.
extern const std::string kFourBar;
/// Members of scenes: an arm along x from the origin to (1 m, 0, 0), and what a hinge at the origin holds, without braces.
extern const std::string kArm, kHinge;

bool contains(const std::string& text, const std::string& part);
/// What a result printed as text has for a label, "1 m" of "  step  1 m"; "" without that label.
std::string value_of(const std::string& text, const std::string& label);
/// The cells of the line of a table that begins with this one, each apart by one blank; "" without such a line.
std::string row_of(const std::string& text, const std::string& first);

}  // namespace lockstep::testing
