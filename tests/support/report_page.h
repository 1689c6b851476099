// SPDX-License-Identifier: BSD-3-Clause
// The page of a report as a script reads it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/catch.h"

namespace lockstep::report_page {

using Json = nlohmann::json;

// What a script reads: from the page's text alone.
inline std::string element(const std::string& page, const std::string& id) {
  const std::size_t at = page.find(" id=\"" + id + "\">");
  REQUIRE(at != std::string::npos);
  const std::size_t begin = page.find('>', at) + 1;
  return page.substr(begin, page.find("</script>", begin) - begin);
}

inline std::vector<unsigned char> bytes_of(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  unsigned group = 0, bits = 0;
  for (const char c : base64) {
    if (c == '=') break;
    group = (group << 6) | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(group >> bits));
  }
  return bytes;
}

template <class T>
std::vector<double> array_of(const std::vector<unsigned char>& bytes, const Json& place) {
  std::vector<T> values(place["n"].get<std::size_t>());
  REQUIRE(place["at"].get<std::size_t>() + values.size() * sizeof(T) <= bytes.size());
  if (values.empty()) return {};
  std::memcpy(values.data(), bytes.data() + place["at"].get<std::size_t>(), values.size() * sizeof(T));
  std::vector<double> all(values.begin(), values.end());
  for (double& v : all) v += place.value("base", 0.0);
  return all;
}

inline std::vector<double> read(const std::vector<unsigned char>& bytes, const Json& place) {
  if (place.value("whole", false))
    return place["bits"] == 16 ? array_of<std::uint16_t>(bytes, place) : array_of<std::uint32_t>(bytes, place);
  return place["bits"] == 64 ? array_of<double>(bytes, place) : array_of<float>(bytes, place);
}

struct Page {
  explicit Page(std::string all)
      : text(std::move(all)), data(Json::parse(element(text, "data"))), bytes(bytes_of(element(text, "numbers"))) {}
  std::vector<double> column(const std::string& name) const {
    for (const Json& c : data["table"]["columns"])
      if (c["name"] == name) return read(bytes, c["values"]);
    FAIL("no column " + name);
    return {};
  }
  std::string text;
  Json data;
  std::vector<unsigned char> bytes;
};

}  // namespace lockstep::report_page
