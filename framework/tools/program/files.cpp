// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/files.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <boost/dll/runtime_symbol_info.hpp>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include <lockstep/author/loader.h>
#include <lockstep/error.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/record/channel_entry.h"
#include "framework/tools/simulation/checkpoint.h"

extern char** environ;

namespace lockstep {

namespace fs = std::filesystem;

std::string in_quotes(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n'\"\\$`*?&|;<>()#~!{}[]") == std::string::npos) return word;
  return "'" + boost::replace_all_copy(word, "'", "'\\''") + "'";
}

std::string output_folder() {
  const char* folder = std::getenv("LOCKSTEP_OUTPUT");
  return folder != nullptr && *folder != 0 ? folder : ".";
}

std::string standard_input() {
  constexpr std::size_t kMost = std::size_t{64} << 20;
  std::string text;
  char part[1 << 16];
  while (text.size() <= kMost) {
    const std::size_t n = std::fread(part, 1, sizeof part, stdin);
    if (n == 0) break;
    text.append(part, n);
  }
  return text;
}

std::string shared_folder(const std::string& name) {
  std::error_code error;
  const fs::path own = boost::dll::program_location(error).parent_path();
  for (const char* prefix : {"../share", "../../share"})  // of lockstep, and of a program that it calls
    if (const fs::path folder = own / prefix / name; fs::is_directory(folder, error))
      return folder.lexically_normal().string();
  return {};
}

std::string scene_or_sample(const std::string& named) {
  constexpr std::string_view kSamples = "samples/scenes/";
  std::error_code error;
  const std::string folder = shared_folder("lockstep/scenes");
  if (folder.empty() || fs::exists(named, error) || error) return named;
  if (named.starts_with(kSamples))
    if (const fs::path sample = fs::path(folder) / named.substr(kSamples.size()); fs::exists(sample, error))
      return sample.string();
  const std::string sample = (fs::path(folder) / named).string();
  throw FileError(
      "there is no scene '" + named + "'; " +
      (fs::exists(sample, error) ? "did you mean '" + sample + "'?" : "check the path, samples are in " + folder));
}

std::string stem_of(const std::string& scene) { return scene == "-" ? "stdin" : fs::path(scene).stem().string(); }

void make_folder(const std::string& folder, const std::string& next) {
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) throw FileError("folder '" + folder + "' cannot be created: " + error.message() + "; " + next);
}

std::string csv_path(const std::string& record, const std::string& scene) {
  if (record == "-") return record;
  const fs::path file = record.empty() ? fs::path(output_folder()) / (stem_of(scene) + ".csv") : fs::path(record);
  make_folder(file.parent_path().string());
  return file.lexically_normal().string();
}

std::string csv_path(const Arguments& args, const System& system) {
  const std::string& record = args["--record"];
  if (!record.ends_with(".csv") && !record.ends_with(".txt") && !channels::owner_of(record, system).second.empty())
    throw UsageError("--record names the CSV file, and \"" + record + "\" begins like a channel; record channels by " +
                     "\"record\" of \"run\" in the scene, or name a file that ends in .csv");
  return csv_path(record, args["scene"]);
}

void check_writable(const std::string& file) {
  std::error_code error;
  const bool there = fs::exists(file, error);
  const std::ofstream out(file, std::ios::app);
  if (!out && errno == ENOMEM) throw std::bad_alloc();
  if (!out) throw FileError("file '" + file + "' cannot be written; check the folder, or name another");
  if (!there) fs::remove(file, error);
}

namespace {

// The key of a value and that of the object that holds it; items of a list have the list's.
struct KeysOfValue {
  std::string own{}, of_object{};
};

// Calls visit(value, its keys, its folder) for every value, whose folder is that of its file. `file`: that of the
// folder; null: not known.
template <class Visit>
void for_each_value(const Value& value, const KeysOfValue& keys, const std::string* file, const fs::path& folder,
                    Visit&& visit) {
  if (value.where.file && value.where.file.get() != file) {
    const std::string& other = *value.where.file;
    return for_each_value(value, keys, &other, fs::path(other).parent_path(), visit);
  }
  visit(value, keys, folder);
  if (const Value::List* list = value.list())
    for (const Value& item : *list) for_each_value(item, keys, file, folder, visit);
  if (const Value::Object* object = value.object())
    for (const auto& member : *object) for_each_value(member.value, {member.key, keys.own}, file, folder, visit);
}

// Calls visit(value, file, its name as written) for every file that a scene is read from: the scenes that it includes,
// and what "file", and "mesh" of a shape, name.
template <class Visit>
void for_each_file(const Scene& scene, Visit&& visit) {
  const std::string* last = nullptr;
  for_each_value(scene.root, {}, nullptr, fs::path(scene.file).parent_path(),
                 [&](const Value& value, const KeysOfValue& keys, const fs::path& folder) {
                   const std::string* file = value.where.file.get();
                   if (file != nullptr && file != last && *file != scene.file) visit(value, fs::path(*file), *file);
                   if (file != nullptr) last = file;
                   // the mesh of a shape is a file, that of a gear is not
                   const bool is_file = keys.own == "file" || (keys.own == "mesh" && keys.of_object == "shapes");
                   if (const std::string* name = value.text(); name != nullptr && is_file)
                     visit(value, folder / *name, *name);
                 });
}

// Throws UsageError if one of these results would replace a file that the scene is read from. Texts of other keys may
// name files too, in types of plugins: they count if they end like a result.
void refuse_inputs(const std::vector<fs::path>& results, const Scene& scene) {
  std::error_code error;
  const auto refuse_if_result = [&](const fs::path& input) {
    if (!fs::is_regular_file(input, error)) return;
    for (const fs::path& result : results)
      if (fs::exists(result, error) && fs::equivalent(input, result, error))
        throw UsageError("the results would replace '" + result.string() +
                         "', a file of the scene; name another (--record, --report)");
  };
  refuse_if_result(scene.file);
  for_each_file(scene, [&](const Value&, const fs::path& file, const std::string&) { refuse_if_result(file); });
  for (const Value* root : {&scene.root, &scene.written})
    for_each_value(*root, {}, nullptr, fs::path(scene.file).parent_path(),
                   [&](const Value& value, const KeysOfValue&, const fs::path& folder) {
                     const std::string* text = value.text();
                     if (text == nullptr || text->empty() || text->size() > 4096) return;
                     const fs::path name = fs::path(*text).filename();
                     if (std::ranges::any_of(results, [&](const fs::path& r) { return r.filename() == name; }))
                       refuse_if_result(folder / *text);
                   });
}

// The table of a run, the file that becomes it, and its picture.
std::vector<fs::path> files_of(const fs::path& csv) {
  return {csv, csv.string() + ".partial", fs::path(csv).replace_extension(".svg"),
          fs::path(csv).replace_extension(".png")};
}

}  // namespace

std::string picture_base(const std::string& csv, const PictureRequest& picture) {
  std::string name = picture.y + "_over_" + picture.x;
  for (char& c : name)
    if (std::string_view("/\\:*?\"<>| ").find(c) != std::string_view::npos) c = '_';
  return fs::path(csv).replace_extension().string() + "." + name;
}

void check_overwrites(const std::string& csv, const Scene& scene, const std::vector<PictureRequest>& pictures) {
  std::vector<fs::path> results = files_of(csv);
  for (const PictureRequest& picture : pictures)
    for (const char* ending : {".svg", ".png"}) results.emplace_back(picture_base(csv, picture) + ending);
  refuse_inputs(results, scene);
}

void check_checkpoint(const std::string& checkpoint, const std::string& csv, const Scene& scene) {
  const fs::path own = fs::path(checkpoint).lexically_normal(), partial = own.string() + ".partial";
  for (const fs::path& taken : files_of(csv))
    if (own == taken.lexically_normal() || partial == taken.lexically_normal())
      throw UsageError("--checkpoint: the checkpoint would replace '" + taken.string() +
                       "', a result; name another file");
  refuse_inputs({own, partial}, scene);
  check_replaceable(checkpoint);
  check_writable(partial.string());
}

std::uint64_t hash_of_files(const Scene& scene) {
  std::set<std::string> files;
  for_each_file(scene, [&](const Value&, const fs::path& file, const std::string&) { files.insert(file.string()); });
  std::uint64_t hash = hash_of(contents_of(scene.file));
  for (const std::string& file : files) hash = hash_of(contents_of(file), hash);
  return hash;
}

std::uint64_t hash_of_plugins(const Scene& scene, const std::vector<std::string>& plugins) {
  std::set<std::string> files;
  for (const std::vector<std::string>* names : {&plugins, &scene.plugins})
    for (const std::string& name : *names) files.insert(find_plugin(name, {}));
  std::uint64_t hash = hash_of("");
  for (const std::string& file : files) hash = hash_of(contents_of(file), hash);
  return hash;
}

// Both paths are made absolute before links are followed: weakly_canonical() leaves a relative path unchanged if its
// beginning does not exist.
void check_file(const std::string& scene, const Value& value, const std::string& path, const std::string& written) {
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(fs::absolute(scene).parent_path(), error);
  const fs::path file = fs::weakly_canonical(fs::absolute(path), error);
  const auto [end, in_file] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  if (end == folder.end()) return;
  throw UsageError(value.where.text() + ": the file \"" + written +
                   "\" is outside the scene's folder; put it there, or allow it with --allow-files");
}

void check_files(const Scene& scene) {
  for_each_file(scene, [&](const Value& value, const fs::path& named, const std::string& written) {
    check_file(scene.file, value, named.string(), written);
  });
}

std::string report_path(const std::string& report, const std::string& csv, const Scene& scene) {
  if (report == "-") throw UsageError("--report: the report needs a file; name one, as in --report out.html");
  const fs::path file = fs::path(report).lexically_normal();
  make_folder(file.parent_path().string());
  for (const fs::path& taken : files_of(csv))
    if (file == taken.lexically_normal())
      throw UsageError("the report would replace '" + taken.string() + "', another result; name it " +
                       fs::path(file).replace_extension(".html").string());
  refuse_inputs({file}, scene);
  check_writable(file.string());
  return file.string();
}

// xdg-open may stay until the browser is closed: it is waited for as long as it takes to fail. Its messages are dropped.
std::string open_in_browser(const std::string& file) {
  std::string program = "xdg-open", path = fs::absolute(file).string();
  char* const words[] = {program.data(), path.data(), nullptr};
  pid_t child = 0;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {1, 2}) posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  const int failed = posix_spawnp(&child, program.c_str(), &actions, nullptr, words, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed == ENOENT) return "xdg-open is not installed (apt install xdg-utils); open " + file + " with a browser";
  if (failed != 0) return std::string("xdg-open cannot be started: ") + std::strerror(failed);
  for (int tenths = 0; tenths < 15; ++tenths) {
    int status = 0;
    if (waitpid(child, &status, WNOHANG) == child)
      return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? ""
                                                           : "xdg-open found no browser; open " + file + " with one";
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return "";
}

}  // namespace lockstep
