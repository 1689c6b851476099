// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace lockstep::fuzz {

namespace {

using nlohmann::json;

class Mutator {
 public:
  explicit Mutator(std::mt19937_64& bits) : bits_(bits) {}
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(bits_() % n); }

  std::string word() {
    static const std::vector<std::string> kWords{"0",
                                                 "-1",
                                                 "1e308",
                                                 "1e-320",
                                                 "nan",
                                                 "inf",
                                                 "-0",
                                                 "9007199254740993",
                                                 "1e999",
                                                 "0.1",
                                                 "\"",
                                                 "\\u0000",
                                                 "[",
                                                 "]",
                                                 "{",
                                                 "}",
                                                 ",",
                                                 ";",
                                                 "\t",
                                                 "\n",
                                                 "\r\n",
                                                 "\xEF\xBB\xBF",
                                                 "mm",
                                                 "rad",
                                                 "rpm",
                                                 "deg",
                                                 "=",
                                                 "(",
                                                 ")",
                                                 "?",
                                                 ":",
                                                 "^",
                                                 "sin(",
                                                 "mod(",
                                                 "t",
                                                 "q",
                                                 ".x",
                                                 "ground",
                                                 "#",
                                                 "//",
                                                 "/*",
                                                 "\xff\xfe",
                                                 "e",
                                                 ".",
                                                 "-",
                                                 "energy.total",
                                                 ".force_on_p_world_x"};
    return kWords[below(kWords.size())];
  }
  json value() {
    static const std::vector<json> kValues{0,
                                           -1,
                                           1,
                                           2.5,
                                           1e-9,
                                           1e308,
                                           -1e308,
                                           5e-324,
                                           true,
                                           false,
                                           nullptr,
                                           "",
                                           "ground",
                                           "5 mm",
                                           "-3 rad/s",
                                           "=1/0",
                                           "=2*3",
                                           "=L",
                                           "auto",
                                           "z",
                                           json::array(),
                                           json::object(),
                                           json::array({0, 0, 0}),
                                           json::array({1, 0, 0}),
                                           json::array({1e30, 0, 0}),
                                           json::array({1, 0, 0, 0}),
                                           json::array({0, 0, 0, 0}),
                                           {{"type", "sine"}, {"amplitude", 1}, {"omega", 50}},
                                           {{"axis", "rz"}, {"law", 1}},
                                           {{"restitution", 1}},
                                           {{"mu", 1e6}},
                                           "quaternion",
                                           "joint",
                                           "omega",
                                           "none",
                                           "baumgarte",
                                           1e9,
                                           1000000007,
                                           "revolute",
                                           "prismatic",
                                           "spherical",
                                           "distance",
                                           "lock"};
    return kValues[below(kValues.size())];
  }

  void bytes(std::string& text) {
    if (text.empty()) {
      text = word();
      return;
    }
    const std::size_t at = below(text.size()), n = std::min(text.size() - at, 1 + below(8));
    switch (below(7)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ static_cast<char>(1u << below(8)));
        break;
      case 1:
        text.erase(at, n);
        break;
      case 2:
        text.insert(at, text.substr(below(text.size()), 1 + below(24)));
        break;
      case 3:
        text.insert(at, word());
        break;
      case 4:
        text.replace(at, n, word());
        break;
      case 5:
        text.resize(at);
        break;
      default:
        text[at] = static_cast<char>(below(256));
    }
  }

  // Any of the values within.
  json& within(json& top) {
    json* at = &top;
    while (at->is_structured() && !at->empty() && (at == &top || below(5) != 0)) {
      auto next = at->begin();
      std::advance(next, static_cast<std::ptrdiff_t>(below(at->size())));
      at = &*next;
    }
    return *at;
  }
  json& structure(json& top) {
    json* at = &top;
    for (int tries = 0; tries < 8; ++tries) {
      json& found = within(top);
      if (found.is_structured() && !found.empty()) at = &found;
    }
    return *at;
  }

  void change(json& top) {
    json& at = within(top);
    switch (below(6)) {
      case 0:
        at = value();
        break;
      case 1:
        at = json(within(top));
        break;  // one value in another's place
      case 2:
        if (at.is_number())
          at = at.get<double>() * (below(2) == 0 ? -1.0 : 1e3 * static_cast<double>(below(5)));
        else
          at = value();
        break;
      case 3: {  // something is missing
        json& whole = structure(top);
        if (!whole.is_structured() || whole.empty()) return;
        auto gone = whole.begin();
        std::advance(gone, static_cast<std::ptrdiff_t>(below(whole.size())));
        whole.erase(gone);
        break;
      }
      case 4: {  // something stands twice, or a key where it does not belong
        json& whole = structure(top);
        if (whole.empty()) return;
        if (whole.is_array())
          whole.push_back(json(whole[below(whole.size())]));
        else if (whole.is_object()) {
          const json other = structure(top);
          if (other.is_object() && !other.empty()) {
            auto taken = other.begin();
            std::advance(taken, static_cast<std::ptrdiff_t>(below(other.size())));
            whole[taken.key()] = taken.value();
          }
        }
        break;
      }
      default:
        if (at.is_string()) {
          std::string text = at.get<std::string>();
          bytes(text);
          at = text;
        } else {
          at = value();
        }
    }
  }

 private:
  std::mt19937_64& bits_;
};

}  // namespace

std::string mutated(std::string text, std::mt19937_64& bits) {
  Mutator mutator(bits);
  for (std::size_t n = 1 + mutator.below(4); n > 0; --n) mutator.bytes(text);
  return text;
}

std::string mutated_scene(const std::string& text, std::mt19937_64& bits) {
  Mutator mutator(bits);
  json scene = json::parse(text, nullptr, false, true);
  if (scene.is_discarded() || mutator.below(16) == 0) return mutated(text, bits);
  for (std::size_t n = 1 + mutator.below(3); n > 0; --n) mutator.change(scene);
  return scene.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace lockstep::fuzz
