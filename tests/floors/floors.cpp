// floors ROOT: reads the #include lines of framework, motionlaws and integrators below ROOT and fails when a file
// includes a higher floor, or a room of its own floor that includes it back. See framework/README.md for the house.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::map<std::string, int> kFloorOf = {
    {"support", 0},  {"math", 0},        {"version", 0},                      //
    {"model", 1},    {"kkt", 1},         {"motionlaws", 1},                   //
    {"lock", 2},     {"force", 2},                                            //
    {"system", 3},   {"links", 3},                                            //
    {"dynamics", 4}, {"integrators", 4},                                      //
    {"analysis", 5}, {"record", 5},      {"plugin", 5},     {"check", 5},     //
    {"copies", 6},   {"scene", 6},       {"builtins", 6},   {"register", 6},  //
    {"runner", 7},   {"lockstep", 7},    {"samples", 7},    {"tests", 7},    {"plugins", 7}};

// Arrows within a floor that are closed even where nothing points back yet: from, to.
const std::set<std::pair<std::string, std::string>> kClosed = {{"model", "kkt"}};

// Folders that may be plugins (LOCKSTEP_BUILTINS=OFF): nothing below the top floor may need them, but their register.cpp.
const std::set<std::string> kMayBePlugins = {"motionlaws", "integrators"};

struct Include {
  std::string file;  // relative to the root
  int line;
  std::string path;      // as written between quotes or angle brackets
  std::string from, to;  // rooms
};

// The room a path belongs to: framework/lock/kernel.h -> lock, motionlaws/ramp.h -> motionlaws,
// framework/builtins.cpp -> builtins, any register.cpp -> register; empty for other people's headers.
std::string room_of(const fs::path& path) {
  std::vector<std::string> parts;
  for (const fs::path& part : path) parts.push_back(part.string());
  static const std::set<std::string> roots = {"framework", "motionlaws", "integrators", "samples", "tests", "plugins"};
  if (parts.size() < 2 || roots.count(parts[0]) == 0) return "";
  const std::string stem = parts.back().substr(0, parts.back().find('.'));
  if (stem == "register" || stem == "register_plugin") return "register";
  if (parts[0] != "framework") return parts[0];
  return parts.size() == 2 ? stem : parts[1];
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

int floor_of(const std::string& room) {
  const auto found = kFloorOf.find(room);
  return found == kFloorOf.end() ? -1 : found->second;
}

std::vector<fs::path> source_files(const fs::path& root) {
  std::vector<fs::path> files;
  for (const char* top : {"framework", "motionlaws", "integrators"}) {
    if (!fs::is_directory(root / top)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      const bool is_code = extension == ".h" || extension == ".cpp" || entry.path().filename() == "version.h.in";
      if (is_code) files.push_back(fs::relative(entry.path(), root));
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

class Inspection {
 public:
  explicit Inspection(fs::path root) : root_(std::move(root)) {}

  int run() {
    const std::vector<fs::path> files = source_files(root_);
    for (const fs::path& file : files) read(file);
    for (const Include& include : includes_) judge(include);
    std::cout << files.size() << " files, " << includes_.size() << " includes between rooms, " << n_faults_
              << " faults\n";
    return n_faults_ == 0 && !files.empty() ? 0 : 1;
  }

 private:
  void read(const fs::path& file) {
    const std::string from = room_of(file);
    if (floor_of(from) < 0) {
      fault(file.generic_string(), 1, "room '" + from + "' has no floor; give it one in tests/floors/floors.cpp");
      return;
    }
    std::ifstream text(root_ / file);
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
      const auto [mark, path] = included(line);
      const std::string to = room_of(path);
      if (to.empty() && mark == '"') {
        fault(file.generic_string(), number,
              "\"" + path + "\" does not start at the root of the repository, as in \"framework/lock/lock.h\"");
      } else if (!to.empty() && to != from) {
        includes_.push_back({file.generic_string(), number, path, from, to});
      }
    }
  }

  void judge(const Include& include) {
    const int from = floor_of(include.from);
    const int to = floor_of(include.to);
    const std::string arrow = "includes \"" + include.path + "\": " + name(include.from) + " may not include ";
    if (to < 0) {
      fault(include.file, include.line, arrow + "room '" + include.to + "', which has no floor");
    } else if (to > from) {
      fault(include.file, include.line, arrow + "the higher " + name(include.to));
    } else if (kMayBePlugins.count(include.to) != 0 && from < 7 && include.from != "register") {
      fault(include.file, include.line, arrow + name(include.to) + ", which may be a plugin");
    } else if (to == from && kClosed.count({include.from, include.to}) != 0) {
      fault(include.file, include.line, arrow + name(include.to) + ", which stands on it");
    } else if (to == from) {
      const Include* back = way(include.to, include.from);
      if (back != nullptr) {
        fault(
            include.file, include.line,
            arrow + name(include.to) + ", which leads back to it at " + back->file + ":" + std::to_string(back->line));
      }
    }
  }

  // The last include of a way from one room to another that stays on its floor; null if there is none.
  const Include* way(const std::string& from, const std::string& to) const {
    std::set<std::string> seen = {from};
    std::vector<std::string> waiting = {from};
    while (!waiting.empty()) {
      const std::string room = waiting.back();
      waiting.pop_back();
      for (const Include& step : includes_) {
        if (step.from != room || floor_of(step.to) != floor_of(from) || kClosed.count({step.from, step.to}) != 0)
          continue;
        if (step.to == to) return &step;
        if (seen.insert(step.to).second) waiting.push_back(step.to);
      }
    }
    return nullptr;
  }

  static std::string name(const std::string& room) { return room + " (floor " + std::to_string(floor_of(room)) + ")"; }

  void fault(const std::string& file, int line, const std::string& what) {
    std::cout << file << ":" << line << ": " << what << "\n";
    ++n_faults_;
  }

  fs::path root_;
  std::vector<Include> includes_;
  int n_faults_ = 0;
};

}  // namespace

int main(int argc, char* argv[]) {
  if (argc != 2) {
    std::cerr << "usage: test_floors ROOT\n";
    return 2;
  }
  return Inspection(argv[1]).run();
}
