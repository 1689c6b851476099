// SPDX-License-Identifier: BSD-3-Clause
// layout ROOT: holds every #include below ROOT against ROOT/framework/layout.txt. A file may include its own room and
// the rooms that are listed before it. The table in ROOT/framework/README.md must be the one that layout.txt makes.
// layout ROOT --table: prints that table.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

// Folders that may be plugins (LOCKSTEP_BUILTINS=OFF): nothing in the library may need them, but the files that register.
const std::set<std::string> kMayBePlugins = {"motionlaws", "integrators"};
// Everything that stands on the library: above the last room.
const std::set<std::string> kUsers = {"samples", "tests", "plugins"};
// Files that register what is built in belong to the registry, wherever they are.
const std::string kRegistry = "framework/description/registry";
const std::set<std::string> kRegistering = {"register", "register_plugin"};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> parts;
  std::stringstream text(line);
  for (std::string part; std::getline(text, part, '|');) parts.push_back(trimmed(part));
  parts.resize(3);
  return parts;
}

// The rooms of layout.txt in their order, and the room of each public header.
struct Layout {
  std::vector<std::string> rooms;
  std::map<std::string, std::string> room_of_header;
};

Layout read_layout(const fs::path& file) {
  Layout layout;
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line.front() != ' ' || trimmed(line).front() == '#') continue;
    const std::vector<std::string> c = cells(line);
    layout.rooms.push_back(c[0]);
    std::stringstream headers(c[2]);
    for (std::string header; headers >> header;) layout.room_of_header["lockstep/" + header] = c[0];
  }
  return layout;
}

// The plan as a table for the tour: a wing in bold, its rooms below it.
std::string table_of(const fs::path& file) {
  std::string table = "| | | public headers |\n|---|---|---|\n";
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);) {
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    const std::vector<std::string> c = cells(line);
    table += line.front() == ' ' ? "| `" + c[0] + "` | " + c[1] + " | " + c[2] + " |\n" : "| **" + c[0] + "** | **" + c[2] + "** | |\n";
  }
  return table;
}

// What is between the two marks of the tour; nothing where there is no tour.
std::string table_in(const fs::path& file) {
  std::ifstream text(file);
  std::string table;
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("<!-- end of layout", 0) == 0) break;
    if (inside) table += line + "\n";
    if (line.rfind("<!-- layout", 0) == 0) inside = true;
  }
  return table;
}

// The opening mark and the path of an #include line; a blank and nothing for any other line.
std::pair<char, std::string> included(std::string line) {
  line.erase(std::remove_if(line.begin(), line.end(), [](char c) { return c == ' ' || c == '\t'; }), line.end());
  const std::string word = "#include";
  if (line.compare(0, word.size(), word) != 0 || line.size() < word.size() + 2) return {' ', ""};
  const char mark = line[word.size()];
  const std::size_t start = word.size() + 1;
  const std::size_t end = line.find(mark == '<' ? '>' : mark, start);
  if ((mark != '<' && mark != '"') || end == std::string::npos) return {' ', ""};
  return {mark, line.substr(start, end - start)};
}

bool is_code(const fs::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".h" || extension == ".cpp" || file.filename() == "version.h.in";
}

class Inspection {
 public:
  explicit Inspection(fs::path root) : root_(std::move(root)), layout_(read_layout(root_ / "framework/layout.txt")), rooms_(layout_.rooms) {}

  int run() {
    const std::vector<fs::path> files = source_files();
    for (const fs::path& file : files) inspect(file);
    for (const std::string& room : rooms_)
      if (!fs::is_directory(root_ / room)) fault("framework/layout.txt", 1, "there is no folder '" + room + "'");
    const fs::path tour = root_ / "framework/README.md";
    if (fs::exists(tour) && table_in(tour) != table_of(root_ / "framework/layout.txt"))
      fault("framework/README.md", 1, "its table of rooms is not that of layout.txt; put in what test_layout ROOT --table prints");
    std::cout << files.size() << " files, " << n_arrows_ << " includes between rooms, " << n_faults_ << " faults\n";
    return n_faults_ == 0 && !files.empty() ? 0 : 1;
  }

 private:
  std::vector<fs::path> source_files() const {
    std::vector<fs::path> files;
    for (const char* top : {"framework", "motionlaws", "integrators"}) {
      if (!fs::is_directory(root_ / top)) continue;
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root_ / top))
        if (is_code(entry.path())) files.push_back(fs::relative(entry.path(), root_));
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  // The room of a file: the one that lists a public header, else the longest listed folder that holds it. The umbrella
  // belongs to nobody and may include all; other people's headers are "".
  std::string room_of(const fs::path& path) const {
    constexpr const char* kPublic = "framework/include/";
    std::string header = path.generic_string();
    if (header.rfind(kPublic, 0) == 0) header.erase(0, std::string(kPublic).size());
    if (header.rfind("lockstep/", 0) == 0) {
      if (header == "lockstep/lockstep.h" || header == "lockstep/version.h") return "framework";
      const auto found = layout_.room_of_header.find(header);
      return found == layout_.room_of_header.end() ? header : found->second;
    }
    const std::string stem = path.filename().string().substr(0, path.filename().string().find('.'));
    const std::string top = path.begin() == path.end() ? "" : path.begin()->string();
    if (kUsers.count(top) != 0) return top;
    if (top != "framework" && kMayBePlugins.count(top) == 0) return "";
    if (kRegistering.count(stem) != 0) return kRegistry;
    if (path.parent_path() == "framework") return "framework";
    std::string best = path.parent_path().generic_string();
    for (const std::string& room : rooms_)
      if (path.generic_string().rfind(room + "/", 0) == 0) best = room;
    return best;
  }

  // Place in the list; users of the library and files beside the wings come last; -1: not listed.
  int rank(const std::string& room) const {
    if (kUsers.count(room) != 0) return static_cast<int>(rooms_.size()) + 1;
    if (room == "framework") return static_cast<int>(rooms_.size());
    const auto found = std::find(rooms_.begin(), rooms_.end(), room);
    return found == rooms_.end() ? -1 : static_cast<int>(found - rooms_.begin());
  }

  void inspect(const fs::path& file) {
    const std::string from = room_of(file);
    if (rank(from) < 0) {
      fault(file.generic_string(), 1, "room '" + from + "' is not listed; add it to framework/layout.txt");
      return;
    }
    std::ifstream text(root_ / file);
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
      const auto [mark, path] = included(line);
      const std::string to = room_of(path);
      if (to.empty() && mark == '"') {
        fault(file.generic_string(), number,
              "\"" + path + "\" does not start at the root of the repository, as in \"framework/mechanism/lock/dispatch.h\"");
      } else if (!to.empty() && to != from && path != "lockstep/version.h") {
        ++n_arrows_;
        judge(file.generic_string(), number, path, from, to);
      }
    }
  }

  void judge(const std::string& file, int line, const std::string& path, const std::string& from,
             const std::string& to) {
    const std::string arrow = "includes \"" + path + "\": " + from + " may not include ";
    if (rank(to) < 0) {
      fault(file, line, arrow + "room '" + to + "', which is not listed");
    } else if (rank(to) > rank(from)) {
      fault(file, line, arrow + to + ", which is listed after it");
    } else if (kMayBePlugins.count(to) != 0 && from != kRegistry && from != "framework") {
      fault(file, line, arrow + to + ", which may be a plugin");
    }
  }

  void fault(const std::string& file, int line, const std::string& what) {
    std::cout << file << ":" << line << ": " << what << "\n";
    ++n_faults_;
  }

  fs::path root_;
  Layout layout_;
  std::vector<std::string> rooms_;
  int n_arrows_ = 0, n_faults_ = 0;
};

}  // namespace

int main(int argc, char* argv[]) {
  if (argc == 3 && std::string(argv[2]) == "--table") {
    std::cout << table_of(fs::path(argv[1]) / "framework/layout.txt");
    return 0;
  }
  if (argc != 2) {
    std::cerr << "usage: test_layout ROOT [--table]\n";
    return 2;
  }
  return Inspection(argv[1]).run();
}
