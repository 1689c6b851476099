// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/plugin.h>

#include <algorithm>
#include <cstring>

#include <lockstep/author/loader.h>
#include <lockstep/error.h>
#include "framework/description/registry/plugin_file.h"

namespace lockstep {
namespace {

std::string version(const std::int32_t (&v)[3]) {
  return std::to_string(v[0]) + "." + std::to_string(v[1]) + "." + std::to_string(v[2]);
}

template <std::size_t N>
std::string field_text(const char (&s)[N]) {
  return {s, std::find(s, s + N, '\0')};
}

std::string flags(const lockstep_abi_record& r) {
  const std::string all = field_text(r.flags);
  return all.find_first_not_of(' ') == std::string::npos ? "none" : all.substr(0, all.find_last_not_of(' ') + 1);
}

// Magic, size and number are at the same place in the record of every version, so that an old plugin is recognised.
lockstep_abi_record record_of(const std::string& path, PluginStamp& stamp) {
  const std::string who = "plugin file '" + path + "' ";
  lockstep_abi_record record{};
  abi_detail::put(record.magic, kAbiMagic);
  const auto [of_file, data] = data_from(path, {record.magic, sizeof record.magic}, sizeof record);
  stamp = of_file;
  if (data.empty())
    throw PluginError(who + "is not a lockstep plugin: it has no record \"" + kAbiMagic +
                      "\"; add a LOCKSTEP_PLUGIN(registry) { ... } to it");
  std::memcpy(static_cast<void*>(&record), data.data(), data.size());
  if (record.size != sizeof record)
    throw PluginError(who + "was built for ABI " + std::to_string(record.abi) + " with a record of " +
                      std::to_string(record.size) + " bytes, this host is ABI " + std::to_string(kAbiNumber) +
                      " with " + std::to_string(sizeof record) + "; rebuild the plugin against this lockstep");
  return record;
}

}  // namespace

lockstep_abi_record read_abi(const std::string& path) {
  PluginStamp stamp;
  return record_of(path, stamp);
}

PluginStamp check_plugin_file(const std::string& file) {
  PluginStamp stamp;
  const std::string difference = abi_difference(record_of(file, stamp), abi_of_this_build());
  if (!difference.empty()) throw PluginError("plugin '" + plugin_name(file) + "': " + difference);
  return stamp;
}

std::string abi_words(const lockstep_abi_record& r) {
  return "ABI " + std::to_string(r.abi) + ", " + field_text(r.compiler) + " " + version(r.compiler_version) + ", " +
         field_text(r.library) + " " + std::to_string(r.library_version) + ", Eigen " + version(r.eigen_version) +
         ", alignment " + std::to_string(r.alignment);
}

std::string abi_difference(const lockstep_abi_record& plugin, const lockstep_abi_record& host) {
  const auto build = [](const lockstep_abi_record& r) {
    return "ABI " + std::to_string(r.abi) + " with " + field_text(r.compiler) + " " + version(r.compiler_version);
  };
  const auto sentence = [](const std::string& its, const std::string& ours) {
    return "built for " + its + ", this host is " + ours +
           "; rebuild the plugin against this lockstep, by lockstep_add_plugin() or with the flags of lockstep.pc";
  };
  if (plugin.abi != host.abi || plugin.size != host.size || field_text(plugin.compiler) != field_text(host.compiler) ||
      plugin.compiler_version[0] != host.compiler_version[0])
    return sentence(build(plugin), build(host));
  const auto differs = [&](const std::string& what, const std::string& its, const std::string& ours) {
    return its == ours ? std::string() : sentence(what + " " + its, what + " " + ours);
  };
  const auto library = [](const lockstep_abi_record& r) {
    return field_text(r.library) + " " + std::to_string(r.library_version) +
           (r.library_abi != 0 ? "" : " (old strings)");
  };
  const auto alignment = [](const lockstep_abi_record& r) {
    return std::to_string(r.alignment) +
           (r.static_alignment == r.alignment ? "" : " (objects " + std::to_string(r.static_alignment) + ")");
  };
  if (flags(plugin).find("fast-math") != std::string::npos && flags(host).find("fast-math") == std::string::npos)
    return "built with -ffast-math, which this lockstep does not accept; rebuild it without";
  for (const std::string& difference :
       {differs("C++", std::to_string(plugin.cxx_level), std::to_string(host.cxx_level)),
        differs("the standard library", library(plugin), library(host)),
        differs("Eigen", version(plugin.eigen_version), version(host.eigen_version)),
        differs("alignment", alignment(plugin), alignment(host)),
        differs("Eigen's index of", std::to_string(plugin.index_size), std::to_string(host.index_size)),
        differs("settings", flags(plugin), flags(host))})
    if (!difference.empty()) return difference;
  return {};
}

}  // namespace lockstep
