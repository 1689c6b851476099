// SPDX-License-Identifier: BSD-3-Clause
// test_pages_writer ROOT FILE: writes all C++ of the pages into one source file, each block in a namespace of its own.
// The compiler names page and line of what is wrong.
#include <cctype>
#include <exception>
#include <fstream>
#include <iostream>
#include <regex>
#include <set>
#include <stdexcept>

#include "tests/pages/page.h"

using namespace lockstep::testing;

namespace {

struct Written {
  std::set<std::string> includes;
  std::string code, table;
};

std::string identifier(std::string place) {
  for (char& c : place)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return place;
}

void write(const Page& page, const Block& block, Written& to) {
  static const std::regex include("#include [^\n]*"), main_function("\\bint main\\(\\)"), test("\\bvoid test\\(\\)");
  const std::string text = block.text(), place = page.place(block.line), space = identifier(place);
  const bool program = std::regex_search(text, main_function);
  if (program && text.find("#include <lockstep/") == std::string::npos)
    throw std::runtime_error(place + ": a program that includes nothing of lockstep");
  for (std::sregex_iterator i(text.begin(), text.end(), include), end; i != end; ++i) to.includes.insert(i->str());

  to.code += "\nnamespace " + space + " {\n";
  for (const Excerpt& piece : block.pieces) {
    const std::string bare = std::regex_replace(piece.text, include, "");
    to.code += "#line " + std::to_string(piece.line) + " \"" + page.name + "\"\n";
    to.code += std::regex_replace(bare, main_function, "void program()");
  }
  to.code += "}\n";
  if (program || std::regex_search(text, test))
    to.table += "    {\"" + place + "\", " + space + (std::regex_search(text, test) ? "::test},\n" : "::program},\n");
}

}  // namespace

int main(int argc, char* argv[]) try {
  if (argc != 3) throw std::runtime_error("test_pages_writer ROOT FILE");
  Written all;
  for (const Page& page : read_pages(argv[1]))
    for (const Block& block : page.blocks)
      if (block.language == "cpp") write(page, block, all);
  std::ofstream file(argv[2]);
  file << "// Written by tests/pages/write.cpp from the pages.\n#include \"tests/pages/page.h\"\n"
       << "#include \"tests/support/catch.h\"\n";
  for (const std::string& include : all.includes) file << include << "\n";
  file << all.code << "\nnamespace lockstep::testing {\nconst std::vector<Example> kExamples = {\n"
       << all.table << "};\n}  // namespace lockstep::testing\n";
  return file.flush() ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
