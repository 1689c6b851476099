#include "framework/description/scene/old_names.h"

#include <spdlog/fmt/fmt.h>

#include <lockstep/log.h>

#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

struct Renamed {
  const char* list;  // key of the scene whose objects have it
  const char* old_name;
  const char* name;
};
constexpr Renamed kRenamed[] = {
    {"markers", "slide", "translation"}, {"markers", "spin", "rotation"}, {"links", "one_sided", "unilateral"}};

void rename(Value::Member& member, const Value& owner, const Renamed& key) {
  if (owner.find(key.name) != nullptr)
    refuse(member.where, key.list,
           fmt::format("\"{}\" is the old name of \"{}\", which is given too; remove one of them", key.old_name,
                       key.name));
  const Where& at = member.where;
  log_warning(fmt::format("{}{}\"{}\" is now called \"{}\"; the next release reads only the new name", at.text(),
                          at.text().empty() ? "" : ": ", key.old_name, key.name));
  member.key = key.name;
}

}  // namespace

void rename_old_keys(Value& root) {
  if (root.object() == nullptr) return;
  for (Value::Member& part : *root.object())
    for (const Renamed& key : kRenamed) {
      if (part.key != key.list || part.value.list() == nullptr) continue;
      for (Value& item : *part.value.list()) {
        if (item.object() == nullptr) continue;
        for (Value::Member& member : *item.object())
          if (member.key == key.old_name) rename(member, item, key);
      }
    }
}

}  // namespace lockstep
