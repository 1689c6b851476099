// SPDX-License-Identifier: BSD-3-Clause
// Lines of a mesh file that is a text, word by word. Private to this room.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lockstep {

/// The lines of a text that hold something: words between blanks, without comments.
class MeshWords {
 public:
  /// `file`: for messages; `text` must outlive this. `comment`: the character that begins one, 0: none.
  MeshWords(std::string file, std::string_view text, char comment);

  /// Goes to the next line that holds a word; a backslash at its end joins the following one to it. False at the end.
  bool next();
  const std::vector<std::string_view>& words() const { return words_; }
  /// Word k as a finite number of single precision. Throws FileError.
  float number(std::size_t k) const;
  /// Throws FileError with file and line.
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  std::string_view line();

  std::string file_;
  std::string_view rest_;
  char comment_;
  long line_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace lockstep
