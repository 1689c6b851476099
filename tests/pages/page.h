// SPDX-License-Identifier: BSD-3-Clause
// The code in a page of Markdown.
#pragma once

#include <string>
#include <vector>

namespace lockstep::testing {

/// Lines of a page.
struct Excerpt {
  int line = 0;  ///< of the page, from 1 on
  std::string text;
};

/// Code as it is tested: a block of the page, or a comment completed by blocks and code spans.
///
///     <!-- cpp
///     struct Gravity {     not shown to readers
///     ...                  the next block or code span of the page
///     ... "friction"       the next code span that begins with these characters
///     };
///     -->
struct Block {
  int line = 0;
  std::string language;  ///< "cpp"; what follows it on the line, as in "cpp bowl/bowl.cpp", is part of it
  std::vector<Excerpt> pieces;
  std::string text() const;
  bool is(const std::string& of) const { return language == of || language.starts_with(of + " "); }
  /// "swing.json" of "json swing.json": the file that the commands of the page find; "" if the block has no name.
  std::string file() const;
};

struct Page {
  std::string name;  ///< "framework/docs/laws.md"
  std::vector<std::string> lines;
  std::vector<Block> blocks;
  std::vector<Excerpt> spans;  ///< code within sentences and tables
  std::string place(int line) const { return name + ":" + std::to_string(line); }
};

/// Throws std::runtime_error: a file that cannot be read, a block without an end, a `...` for which there is no code.
Page read_page(const std::string& root, const std::string& name);

/// README.md, those of plugins and of the folder framework, and framework/docs/*.md.
std::vector<Page> read_pages(const std::string& root);

/// A new folder of the runner (tests/support/program.h) with the samples and the files that the page names; its name.
std::string folder_of(const Page&, const std::string& purpose);

/// A command line in such a folder; its results are written there.
struct Called;  // tests/support/program.h
Called call_in(const std::string& folder, const std::string& line);

/// A block of C++ that can be run: its test(), or its main() where it has none.
struct Example {
  const char* place;
  void (*run)();
};
extern const std::vector<Example> kExamples;

}  // namespace lockstep::testing
