// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/reading.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

struct Renamed {
  const char* list;  // key of the scene whose objects have it
  const char* old_name;
  const char* name;
};
constexpr Renamed kRenamed[] = {{"markers", "slide", "translation"},
                                {"markers", "spin", "rotation"},
                                {"links", "one_sided", "unilateral"},
                                {"links", "slip", "offset"}};

// Logs that `old_name` is outdated, at a place or, if that is "", on the command line.
void warn(const std::string& place, const Renamed& key) {
  Finding f{&finding::renamed_key, "", fmt::format("\"{}\" is now called \"{}\"", key.old_name, key.name),
            "the next release reads only the new name"};
  f.place = place;
  report_finding(f);
}

void rename(Value::Member& member, const Value& owner, const Renamed& key) {
  if (owner.find(key.name) != nullptr)
    refuse(
        member.where, key.list,
        fmt::format("\"{0}\" is the old name of \"{1}\", which is given too; remove \"{0}\"", key.old_name, key.name));
  warn(member.where.text(), key);
  member.key = key.name;
}

void rename_choice(Value::Object& run) {
  for (Value::Member& m : run) {
    if (m.key != "nearly_redundant" || m.value.text() == nullptr || *m.value.text() != "told") continue;
    const SourceLocation where = m.value.where;
    warn(where.text(), {"run", "told", "report"});
    m.value = "report", m.value.where = where;
  }
}

// "joints" is another name of "links": both are one list, in the order of the file.
void join_lists(Value& part) {
  if (part.object() == nullptr) return;
  Value::Object& members = *part.object();
  Value::Member* first = nullptr;
  std::erase_if(members, [&](Value::Member& m) {
    if (m.key != "joints" && m.key != "links") return false;
    m.key = "links";
    if (first == nullptr || m.value.list() == nullptr || first->value.list() == nullptr) return first = &m, false;
    std::ranges::move(*m.value.list(), std::back_inserter(*first->value.list()));
    return true;
  });
}

}  // namespace

void rename_old_keys(std::string& path) {
  if (path.starts_with("joints.")) path.replace(0, 6, "links");
  const std::size_t first = std::min(path.find('.'), path.size()), second = path.find('.', first + 1);
  if (second == std::string::npos) return;
  const std::string list = path.substr(0, first), step = path.substr(second + 1, path.find('.', second + 1) - second - 1);
  for (const Renamed& key : kRenamed)
    if (list == key.list && step == key.old_name) warn("", key), path.replace(second + 1, step.size(), key.name);
}

void rename_old_keys(Value& root) {
  if (root.object() == nullptr) return;
  join_lists(root);
  for (Value::Member& part : *root.object()) {
    if (part.key == "run" && part.value.object() != nullptr) rename_choice(*part.value.object());
    if (part.key == "repeat" && part.value.list() != nullptr) std::ranges::for_each(*part.value.list(), join_lists);
    for (const Renamed& key : kRenamed) {
      if (part.key != key.list || part.value.list() == nullptr) continue;
      for (Value& item : *part.value.list()) {
        if (item.object() == nullptr) continue;
        for (Value::Member& member : *item.object())
          if (member.key == key.old_name) rename(member, item, key);
      }
    }
  }
}

}  // namespace lockstep
