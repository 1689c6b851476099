// SPDX-License-Identifier: BSD-3-Clause
// A plugin that registers badly, in the way that LOCKSTEP_TEST_RUDE says.
#include <unwind.h>

#include <cstdlib>
#include <exception>
#include <stdexcept>

#include <lockstep/author/plugin.h>

namespace {

struct Still final : lockstep::MotionLaw {
  lockstep::LawValue at(double) const override { return {}; }
};

lockstep::LawPtr<lockstep::MotionLaw> still(const lockstep::Params&) { return std::make_shared<Still>(); }

struct Silent final : std::exception {
  const char* what() const noexcept override { return nullptr; }
};

// As the runtime of another language throws.
void throw_foreign() {
  static _Unwind_Exception thrown{};
  thrown.exception_class = 0x1234;
  thrown.exception_cleanup = nullptr;
  _Unwind_RaiseException(&thrown);
}

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
    registry.laws.add({"odd", "", {{"a", lockstep::Form::text, lockstep::Unit::none, 3, ""}}}, &still);
  if (how == "std") throw std::out_of_range("no such cam");
  if (how == "int") throw 42;
  if (how == "no words") throw Silent();
  if (how == "foreign") throw_foreign();
  if (how == "built in") registry.laws.set_origin("built in");
  if (how == "bell") registry.laws.add({"loud", "rings: \a", {}}, &still);
  if (how == "latin") registry.laws.add({"l\xe4ut", "", {}}, &still);
  if (how == "key bell")
    registry.laws.add({"loud", "", {{"a\a", lockstep::Form::number, lockstep::Unit::none, 1, ""}}}, &still);
  if (how == "error") throw lockstep::ModelError("a model that cannot be");
  if (how == "nested") {
    try {
      throw std::runtime_error("line 3 has no number");
    } catch (...) {
      std::throw_with_nested(lockstep::FileError("cam.csv cannot be read"));
    }
  }
}
