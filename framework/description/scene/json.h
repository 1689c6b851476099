// SPDX-License-Identifier: BSD-3-Clause
// Parses JSON texts and files to a Value, in which every key and value has its place in the text.
#pragma once

#include <cstddef>
#include <string>

#include <lockstep/author/params.h>

namespace lockstep {

inline constexpr std::size_t kMostDepth = 64;                 ///< nesting of objects and lists, and of scenes
inline constexpr std::size_t kMostBytes = 64u * 1024 * 1024;  ///< size of a text

/// The value of `text` (JSON, UTF-8, with comments // and /* */); `file_name` appears in messages and in every Where.
/// Columns count characters. Throws SceneError with the place: syntax errors, a key twice in one object (with both
/// places), NaN and infinity, numbers beyond 1e308, depth beyond kMostDepth, size beyond kMostBytes.
LOCKSTEP_API Value read_json(const std::string& text, const std::string& file_name);

/// The Value of the file. Throws FileError when the file cannot be read, SceneError for its content.
LOCKSTEP_API Value read_json_file(const std::string& path);

}  // namespace lockstep
