// Script: the commands of one picture, handed to gnuplot. Nothing passes through a shell, and no text of the user's can
// become a command.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <lockstep/export.h>

namespace lockstep {

/// Where gnuplot is in PATH; "" when it is not installed.
LOCKSTEP_API std::string find_gnuplot();

class LOCKSTEP_API Script {
 public:
  Script& line(std::string_view commands);
  /// Numbers as the data block `$name`, a row a line; what is not finite becomes a gap. Blank rows by `gap`.
  Script& begin_data(std::string_view name);
  Script& row(std::span<const double> numbers);
  Script& gap();
  Script& end_data();
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A text as gnuplot takes it literally: in single quotes. A single quote inside becomes a typographic one (gnuplot 5.4
/// misreads a doubled one at the beginning), control characters become blanks.
LOCKSTEP_API std::string quoted_text(std::string_view text);

/// Draws the script twice, as `<base>.svg` and `<base>.png`, width x height pixels; base is `path` without .svg or
/// .png. Throws FileError: gnuplot is missing, refuses (with its own words), or a file cannot be written.
LOCKSTEP_API void draw(const Script& script, const std::string& path, int width, int height);

}  // namespace lockstep
