// SPDX-License-Identifier: BSD-3-Clause
// Script: the gnuplot commands of one picture. No shell is involved, and no text of the user's can become a command.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <lockstep/detail/export.h>

namespace lockstep {

/// The path of gnuplot; "" if it is not in PATH.
LOCKSTEP_API std::string find_gnuplot();

class LOCKSTEP_API Script {
 public:
  Script& line(std::string_view commands);
  /// A data block `$name`: rows of numbers, in which a value that is not finite is a gap; one without numbers is blank.
  Script& begin_data(std::string_view name);
  Script& row(std::span<const double> numbers);
  Script& end_data();
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// The text as a gnuplot literal, in single quotes. A single quote inside becomes a typographic one (gnuplot 5.4
/// misreads a doubled one at the beginning), control characters become blanks.
LOCKSTEP_API std::string quoted_text(std::string_view text);

/// Draws the script twice, as `<base>.svg` and `<base>.png`, width x height pixels; base is `path` without .svg or
/// .png. Throws FileError: gnuplot is missing, fails (with its message), or a file cannot be written.
LOCKSTEP_API void draw(const Script& script, const std::string& path, int width, int height);

}  // namespace lockstep
