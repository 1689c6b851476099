// A plugin that registers badly, in the way that LOCKSTEP_TEST_RUDE says.
#include <cstdlib>
#include <exception>
#include <stdexcept>

#include "framework/plugin/plugin.h"

namespace {

struct Still final : lockstep::MotionLaw {
  lockstep::LawValue at(double) const override { return {}; }
};

lockstep::LawPtr<lockstep::MotionLaw> still(const lockstep::Params&) { return std::make_shared<Still>(); }

}  // namespace

LOCKSTEP_PLUGIN(registry) {
  const char* wish = std::getenv("LOCKSTEP_TEST_RUDE");
  const std::string how = wish == nullptr ? "" : wish;
  registry.laws.add({"rude_law", "stands before the failure", {}}, &still);
  if (how == "twice") registry.laws.add({"rude_law", "", {}}, &still);
  if (how == "taken") registry.laws.add({"sine", "", {}}, &still);
  if (how == "as probe") registry.laws.add({"probe_law", "", {}}, &still);
  if (how == "nameless") registry.laws.add({"", "", {}}, &still);
  if (how == "no maker") registry.laws.add({"unmade", "", {}}, nullptr);
  if (how == "bad key")
    registry.laws.add({"odd", "", {{"a", lockstep::Form::text, lockstep::Unit::none, "no JSON", ""}}}, &still);
  if (how == "std") throw std::out_of_range("no such cam");
  if (how == "int") throw 42;
  if (how == "error") throw lockstep::ModelError("a model that cannot be");
  if (how == "nested") {
    try {
      throw std::runtime_error("line 3 has no number");
    } catch (...) {
      std::throw_with_nested(lockstep::FileError("cam.csv cannot be read"));
    }
  }
}
