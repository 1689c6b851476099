// SPDX-License-Identifier: BSD-3-Clause
// JSON: texts and files as a Value, in which every key and value has its place in the text, and back.
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

/// Pretty JSON, ending with a newline; short lists of plain values are on one line. Numbers have the shortest form that
/// reads back as the same double, whatever the locale. Throws SceneError for NaN or infinity, which JSON cannot hold.
LOCKSTEP_API std::string write_json(const Value&);

/// The same in one line, without a newline at its end.
LOCKSTEP_API std::string write_json_line(const Value&);

}  // namespace lockstep
