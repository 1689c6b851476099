#pragma once
/// @file Messages of errors, for tests about what they say.

#include <initializer_list>
#include <string>

/// What the error of type E said that `act` threw; "nothing was thrown" otherwise. Other errors pass through.
template <class E, class F> std::string message_of(F&& act) {
  try {
    act();
  } catch (const E& e) {
    return e.what();
  }
  return "nothing was thrown";
}

/// All parts stand in the text.
inline bool says(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts)
    if (text.find(part) == std::string::npos) return false;
  return true;
}
