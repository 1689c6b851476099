// SPDX-License-Identifier: BSD-3-Clause
#include "framework/foundation/support/thrown.h"

#include <cxxabi.h>

#include <algorithm>
#include <boost/core/demangle.hpp>
#include <string_view>

namespace lockstep {
namespace {

std::string type_in_flight() {
  const std::type_info* type = abi::__cxa_current_exception_type();
  if (type == nullptr) return "something that is not a C++ exception";
  return "an object of type " + type_words(*type);
}

}  // namespace

std::string what_of(const std::exception& error) {
  const char* words = error.what();
  return words == nullptr ? "" : words;
}

std::string type_words(const std::type_info& type) { return boost::core::demangle(type.name()); }

// Mangled names: N8lockstep... of a class, ZN8lockstep... of one within a function, a lambda for instance.
bool is_of_lockstep(const std::type_info& type) {
  std::string_view name = type.name();
  name.remove_prefix(std::min(name.find_first_not_of("Z*"), name.size()));
  return name.starts_with("N8lockstep") || name.starts_with("NK8lockstep");
}

std::string thrown_words(const std::exception_ptr& thrown) {
  if (!thrown) return "something that is not a C++ exception";
  try {
    std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const std::exception& error) {
    std::string words = what_of(error);
    const auto* outer = dynamic_cast<const std::nested_exception*>(&error);
    if (outer != nullptr && outer->nested_ptr() != nullptr) words += ": " + thrown_words(outer->nested_ptr());
    return words.empty() ? type_in_flight() + " without a message" : words;
  } catch (...) {
    return type_in_flight() + ", which is not a std::exception";
  }
}

}  // namespace lockstep
