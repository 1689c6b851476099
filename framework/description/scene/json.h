// JSON text to Value, every key and value with its place in the text. Files are read by framework/description/scene/read.h.
#pragma once

#include <cstddef>
#include <string>

#include <lockstep/params.h>
#include <lockstep/export.h>

namespace lockstep {

inline constexpr std::size_t kMostDepth = 64;                 ///< objects and lists inside each other
inline constexpr std::size_t kMostBytes = 64u * 1024 * 1024;  ///< size of a text

/// The value that `text` (plain JSON, UTF-8, no comments) describes; `file_name` stands in messages and in every Where.
/// Columns count characters. Throws SceneError with the place: syntax errors, a key twice in one object (with both
/// places), NaN and infinity, numbers beyond 1e308, depth beyond kMostDepth, size beyond kMostBytes.
LOCKSTEP_API Value read_json(const std::string& text, const std::string& file_name);

}  // namespace lockstep
