#include "framework/foundation/support/thrown.h"

#include <cxxabi.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <typeinfo>

namespace lockstep {
namespace {

std::string type_in_flight() {
  const std::type_info* type = abi::__cxa_current_exception_type();
  if (type == nullptr) return "something that is not a C++ exception";
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> name(abi::__cxa_demangle(type->name(), nullptr, nullptr, &status),
                                                    std::free);
  return std::string("an object of type ") + (status == 0 ? name.get() : type->name());
}

}  // namespace

std::string what_of(const std::exception& error) {
  const char* words = error.what();
  return words == nullptr ? "" : words;
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
    return type_in_flight() + ", which is not an exception";
  }
}

}  // namespace lockstep
