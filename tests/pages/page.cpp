// SPDX-License-Identifier: BSD-3-Clause
#include "tests/pages/page.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace lockstep::testing {
namespace {

namespace fs = std::filesystem;

// A block or a span, in the order of the page.
struct Code {
  Excerpt piece;
  std::string language;  // "" for a span
  bool used = false;     // in a comment
};

struct Reader {
  Page page;
  std::vector<Code> codes;
  std::vector<Block> comments;  // one piece a line

  const std::string& line(int n) const { return page.lines.at(n - 1); }
  [[noreturn]] void fail(int n, const std::string& what) const {
    throw std::runtime_error(page.place(n) + ": " + what);
  }

  void read_lines(const std::string& root) {
    std::ifstream file(root + "/" + page.name);
    if (!file) throw std::runtime_error("cannot read " + root + "/" + page.name);
    for (std::string text; std::getline(file, text);) page.lines.push_back(text);
  }

  // The number of the line that is `end`, from line n on.
  int find(int n, const std::string& end) const {
    for (int k = n; k <= static_cast<int>(page.lines.size()); ++k)
      if (line(k) == end) return k;
    fail(n, "no end of this block: a line " + end);
  }

  void sort_out() {
    bool in_span = false;
    for (int n = 1; n <= static_cast<int>(page.lines.size()); ++n) {
      const std::string& text = line(n);
      if (text.starts_with("```")) {
        const int end = find(n + 1, "```");
        Code block{{n + 1, ""}, text.substr(3)};
        for (int k = n + 1; k < end; ++k) block.piece.text += line(k) + "\n";
        codes.push_back(block);
        n = end;
      } else if (text.starts_with("<!-- ") && !text.ends_with("-->")) {
        const int end = find(n + 1, "-->");
        Block comment{n, text.substr(5), {}};
        for (int k = n + 1; k < end; ++k) comment.pieces.push_back({k, line(k) + "\n"});
        comments.push_back(comment);
        n = end;
      } else {
        read_spans(n, text, in_span);
      }
    }
  }

  void read_spans(int n, const std::string& text, bool& inside) {
    if (inside) codes.back().piece.text += "\n";
    for (const char c : text) {
      if (c == '`') {
        inside = !inside;
        if (inside) codes.push_back({{n, ""}, ""});
      } else if (inside) {
        codes.back().piece.text += c;
      }
    }
  }

  // What a line "..." or "... begin" of a comment is replaced by.
  Excerpt completed(const Excerpt& placeholder, const std::string& begin) {
    for (Code& code : codes) {
      if (code.piece.line <= placeholder.line || code.used) continue;
      if (!begin.empty() && !(code.language.empty() && code.piece.text.starts_with(begin))) continue;
      code.used = true;
      return {code.piece.line, code.piece.text + (code.language.empty() ? "\n" : "")};
    }
    fail(placeholder.line, "no code after it for ... " + begin);
  }

  void complete(Block& comment) {
    for (Excerpt& piece : comment.pieces) {
      const std::size_t at = piece.text.find_first_not_of(' ');
      const std::string text = at == std::string::npos ? "" : piece.text.substr(at, piece.text.size() - at - 1);
      if (text == "...") piece = completed(piece, "");
      if (text.starts_with("... ")) piece = completed(piece, text.substr(4));
    }
    page.blocks.push_back(comment);
  }

  Page read(const std::string& root) {
    read_lines(root);
    sort_out();
    for (Block& comment : comments) complete(comment);
    for (const Code& code : codes) {
      if (code.language.empty())
        page.spans.push_back(code.piece);
      else if (!code.used)
        page.blocks.push_back({code.piece.line - 1, code.language, {code.piece}});
    }
    std::sort(page.blocks.begin(), page.blocks.end(), [](const Block& a, const Block& b) { return a.line < b.line; });
    return page;
  }
};

}  // namespace

std::string Block::text() const {
  std::string all;
  for (const Excerpt& piece : pieces) all += piece.text;
  return all;
}

std::string Block::file() const {
  const std::size_t space = language.find(' ');
  return space == std::string::npos ? "" : language.substr(space + 1);
}

Page read_page(const std::string& root, const std::string& name) {
  Reader reader;
  reader.page.name = name;
  return reader.read(root);
}

std::vector<Page> read_pages(const std::string& root) {
  std::vector<std::string> names = {"README.md", "plugins/README.md"};
  for (const char* folder : {"framework", "framework/docs"})
    for (const fs::directory_entry& entry : fs::directory_iterator(root + "/" + folder))
      if (entry.path().extension() == ".md")
        names.push_back(std::string(folder) + "/" + entry.path().filename().string());
  std::sort(names.begin(), names.end());
  std::vector<Page> pages;
  for (const std::string& name : names) pages.push_back(read_page(root, name));
  return pages;
}

}  // namespace lockstep::testing
