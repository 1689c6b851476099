// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/reading.h"

#include <algorithm>

namespace lockstep {
namespace {

// Both lists are one, in the order of the file.
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

void rename_joints(std::string& path) {
  if (path.starts_with("joints.")) path.replace(0, 6, "links");
}

void rename_joints(Value& root) {
  if (root.object() == nullptr) return;
  join_lists(root);
  for (Value::Member& part : *root.object())
    if (part.key == "repeat" && part.value.list() != nullptr) std::ranges::for_each(*part.value.list(), join_lists);
}

}  // namespace lockstep
