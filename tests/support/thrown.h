// SPDX-License-Identifier: BSD-3-Clause
// What an act throws: its type's word and its message.
#pragma once

#include <string>

#include <lockstep/error.h>

namespace lockstep::testing {

/// "PluginError: message"; "nothing" when it returns.
template <class Act>
std::string thrown_by(Act&& act) {
  try {
    act();
  } catch (const UserCodeError& e) {
    return std::string("UserCodeError: ") + e.what();
  } catch (const NonFiniteError& e) {
    return std::string("NonFiniteError: ") + e.what();
  } catch (const StepError& e) {
    return std::string("StepError: ") + e.what();
  } catch (const SceneError& e) {
    return std::string("SceneError: ") + e.what();
  } catch (const PluginError& e) {
    return std::string("PluginError: ") + e.what();
  } catch (const ModelError& e) {
    return std::string("ModelError: ") + e.what();
  } catch (const Error& e) {
    return std::string("Error: ") + e.what();
  } catch (const std::exception& e) {
    return std::string("a foreign exception: ") + e.what();
  } catch (...) {
    return "no exception";
  }
  return "nothing";
}

}  // namespace lockstep::testing
