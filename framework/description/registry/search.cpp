// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/loader.h>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <boost/dll/shared_library.hpp>
#include <filesystem>
#include <new>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/registry/survey.h"
#include "framework/foundation/support/lines.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;
namespace dll = boost::dll;

std::string ending() { return dll::shared_library::suffix().string(); }

fs::path own_file() {
  std::error_code error;
  return dll::symbol_location_ptr(&plugin_folders, error);
}

bool holds(const fs::path& folder, const fs::path& file) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return !folder.empty() && end == folder.end() && rest != file.end();
}

bool is_own_group(gid_t group) {
  std::vector<gid_t> groups(std::max(0, getgroups(0, nullptr)));
  if (!groups.empty()) groups.resize(std::max(0, getgroups(static_cast<int>(groups.size()), groups.data())));
  return group == getegid() || std::find(groups.begin(), groups.end(), group) != groups.end();
}

// Why another user could replace that code: "" if only you, root, or the owner of this library can.
std::string stranger_at(const fs::path& path) {
  struct stat s = {}, own = {};
  if (stat(path.c_str(), &s) != 0) return "it cannot be examined";
  if (stat(own_file().c_str(), &own) != 0) own.st_uid = 0, own.st_gid = 0;
  const std::string whose = S_ISDIR(s.st_mode) ? "its folder " + path.string() : "the file";
  if (s.st_uid != 0 && s.st_uid != geteuid() && s.st_uid != own.st_uid)
    return whose + " belongs to user " + std::to_string(s.st_uid) + ", neither you nor root; change its owner (chown)";
  if ((s.st_mode & S_IWOTH) != 0) return whose + " is writable by all users; chmod o-w it";
  if ((s.st_mode & S_IWGRP) != 0 && s.st_gid != 0 && s.st_gid != own.st_gid && !is_own_group(s.st_gid))
    return whose + " is writable by group " + std::to_string(s.st_gid) + ", which is not yours; chmod g-w it";
  return {};
}

// Where a path leads to; empty if nowhere. To follow it needs memory: without it nothing is known of the path.
fs::path followed(const fs::path& path) {
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  if (error == std::errc::not_enough_memory) throw std::bad_alloc();
  return real;
}

// Why a file that was found by its name in a folder, and its links followed, must not be loaded.
std::string problem_of(const fs::path& file, const fs::path& folder, const std::vector<std::string>& folders) {
  if (file.empty()) return "it is a broken symbolic link";
  if (fs::is_directory(file)) return "it is a folder";
  if (std::ranges::none_of(folders, [&](const std::string& allowed) { return holds(followed(allowed), file); }))
    return "it is a link out of the plugin folders, to " + file.string() +
           "; add that folder to LOCKSTEP_PLUGIN_PATH, or give the path";
  for (const fs::path& p : {file, file.parent_path(), followed(folder)})
    if (std::string stranger = stranger_at(p); !stranger.empty()) return stranger;
  return {};
}

// The path as it is, with the extension of a library, and also with the prefix "lib".
std::vector<fs::path> spellings(const fs::path& path) {
  if (path.extension() == ending()) return {path};
  fs::path with = path;
  with += ending();
  return {path, with, with.parent_path() / ("lib" + with.filename().string())};
}

std::string file_at(const std::string& path) {
  for (const fs::path& file : spellings(path))
    if (const fs::path real = followed(file); !real.empty())
      if (!fs::is_directory(real) || file.extension() == ending()) return real.string();
  throw PluginError("plugin '" + path + "': there is no such file; check the path, or build it first");
}

}  // namespace

std::vector<std::string> plugin_folders() {
  std::vector<std::string> folders;
  const auto add = [&](const fs::path& folder) {
    const std::string name = folder.lexically_normal().string();
    if (!name.empty() && std::find(folders.begin(), folders.end(), name) == folders.end()) folders.push_back(name);
  };
  if (const char* path = secure_getenv("LOCKSTEP_PLUGIN_PATH"))
    for (const std::string& folder : lines_of(path, ':')) add(folder);
  std::error_code error;
  const fs::path program = dll::program_location(error), library = own_file();
  if (!program.empty()) add(program.parent_path() / ".." / "plugins");
  if (program.parent_path().parent_path().filename() == "libexec")  // called by lockstep: near the folder of that
    add(program.parent_path() / ".." / ".." / "plugins");
  if (!library.empty()) add(library.parent_path() / ".." / "plugins");
  if (!library.empty()) add(library.parent_path() / "lockstep" / "plugins");
  return folders;
}

std::string plugin_name(const std::string& path) {
  const fs::path file = path;
  const std::string stem = file.extension() == ending() ? file.stem().string() : file.filename().string();
  return stem.rfind("lib", 0) == 0 ? stem.substr(3) : stem;
}

bool is_bare_name(const std::string& name) {
  constexpr const char* kGood = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+.";
  return !name.empty() && name.front() != '.' && name.find_first_not_of(kGood) == std::string::npos;
}

std::string find_plugin(const std::string& name, std::vector<std::string> folders) {
  if (name.find('/') != std::string::npos) return file_at(name);
  if (folders.empty()) folders = plugin_folders();
  std::error_code error;
  for (const std::string& folder : folders)
    for (const fs::path& spelled : spellings(fs::path(folder) / name)) {
      if (spelled.extension() != ending() || fs::symlink_status(spelled, error).type() == fs::file_type::not_found)
        continue;
      const fs::path file = followed(spelled);
      const std::string problem = problem_of(file, folder, folders);
      if (problem.empty()) return file.string();
      throw PluginError("plugin '" + name + "' (" + spelled.string() + ") is not loaded: " + problem);
    }
  throw PluginError("plugin '" + name + "' not found; looked in " +
                    (folders.empty() ? "no folder" : text::join(folders)) +
                    "; give its path, or add its folder to LOCKSTEP_PLUGIN_PATH");
}

std::vector<PluginCandidate> files_in(const std::vector<std::string>& folders) {
  std::vector<PluginCandidate> found;
  for (const std::string& folder : folders) {
    std::error_code error;
    std::vector<fs::path> paths;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (it->path().extension() == ending()) paths.push_back(it->path());
    std::ranges::sort(paths, {}, [](const fs::path& p) {  // in the order of find_plugin()
      return std::pair(plugin_name(p.string()), p.string().size());
    });
    for (const fs::path& path : paths) {
      const fs::path file = followed(path);
      PluginCandidate& c = found.emplace_back();
      c.name = plugin_name(path.string()), c.folder = folder, c.path = path.string();
      c.file = file.empty() ? c.path : file.string(), c.why = problem_of(file, folder, folders);
    }
  }
  return found;
}

}  // namespace lockstep
