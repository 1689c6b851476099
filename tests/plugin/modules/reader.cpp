// SPDX-License-Identifier: BSD-3-Clause
// A law, a link and a force that read a file, and say in their refusal what is in it.
#include <fstream>

#include <lockstep/author/plugin.h>
#include <lockstep/splines.h>

namespace {

using namespace lockstep;

TypeInfo info(const char* name) {
  return {name, "refuses its file, with what it holds", {{"file", Form::text, Unit::none, kOptional, "a text"}}};
}

[[noreturn]] void refuse(const Params& p) {
  std::ifstream in(p.text("file"));
  std::string word = "nothing";
  in >> word;
  p.refuse("file", "holds " + word);
}

LawPtr<MotionLaw> read_table(const Params& p) {
  const Columns table = points_of(p, 1, "t", {"y"});
  p.refuse("file", "ends at " + std::to_string(table.t.back()));
}

}  // namespace

LOCKSTEP_PLUGIN(registry) {
  registry.laws.add(info("reading_law"), [](const Params& p) -> LawPtr<MotionLaw> { refuse(p); });
  registry.links.add(info("reading_link"),
                     [](const Attachment&, const Params& p) -> std::unique_ptr<Lock> { refuse(p); });
  registry.forces.add(info("reading_force"),
                      [](const Attachment&, const Params& p) -> std::unique_ptr<Force> { refuse(p); });
  TypeInfo table = info("table_law");
  table.keys.push_back({"points", Form::points, Unit::none, kOptional, "the same as a list"});
  registry.laws.add(table, &read_table);
}
