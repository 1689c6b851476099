// SPDX-License-Identifier: BSD-3-Clause
// Meshes: STL, binary and as text, and OBJ.
#include <algorithm>
#include <bit>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/container_hash/hash.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <unordered_map>

#include <lockstep/error.h>
#include <lockstep/solid.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

constexpr std::size_t kMostTriangles = 1'000'000;
constexpr std::size_t kStlHead = 84, kStlTriangle = 50;  // bytes

using Corner = std::array<float, 3>;

std::string too_many_triangles() {
  return "it has more than " + std::to_string(kMostTriangles) +
         " triangles; make it coarser, for example with MeshLab or Blender";
}

// Triangles by their corners, each of which is kept once.
class Gatherer {
 public:
  // One without an area is left out.
  void add(const Corner& a, const Corner& b, const Corner& c) {
    if (a != b && b != c && c != a) mesh_.triangles.push_back({number(a), number(b), number(c)});
  }
  std::size_t n_triangles() const { return mesh_.triangles.size(); }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t number(Corner c) {
    for (float& x : c) x += 0.0F;  // no -0
    const auto [at, added] = numbers_.try_emplace(c, static_cast<std::uint32_t>(mesh_.points.size()));
    if (added) mesh_.points.push_back(c);
    return at->second;
  }

  TriangleMesh mesh_;
  std::unordered_map<Corner, std::uint32_t, boost::hash<Corner>> numbers_;
};

// Words as the formats have them: STL's in either case.
bool same_word(std::string_view word, std::string_view expected) {
  return boost::iequals(word, expected, std::locale::classic());
}

// The lines of a text that hold something: words between blanks, without comments.
class MeshWords {
 public:
  // `file`: for messages; `text` must outlive this. `comment`: the character that begins one, 0: none.
  MeshWords(std::string file, std::string_view text, char comment)
      : file_(std::move(file)), rest_(text), comment_(comment) {}

  // Goes to the next line that holds a word; a backslash at its end joins the following one to it. False at the end.
  bool next() {
    words_.clear();
    while (!rest_.empty()) {
      constexpr std::string_view kBlanks = " \t\r\v\f";
      std::string_view left = text::trimmed(line(), kBlanks);
      const bool goes_on = !left.empty() && left.back() == '\\';
      if (goes_on) left.remove_suffix(1);
      while (!left.empty()) {
        const std::size_t end = std::min(left.find_first_of(kBlanks), left.size());
        if (end != 0) words_.push_back(left.substr(0, end));
        left.remove_prefix(std::min(end + 1, left.size()));
      }
      if (!words_.empty() && !goes_on) return true;
    }
    return !words_.empty();
  }
  const std::vector<std::string_view>& words() const { return words_; }
  // Word k as a finite number of single precision, read as a double first: a number too small for it is 0.
  float number(std::size_t k) const {
    if (k >= words_.size()) refuse("the line ends, but a number is expected");
    const std::string_view word = words_[k];
    const auto value = number_in<double>(word.substr(word.starts_with('+') ? 1 : 0));
    if (!value || !(std::abs(*value) <= std::numeric_limits<float>::max()))
      refuse("\"" + std::string(word.substr(0, 40)) + "\" is not a number of single precision");
    return static_cast<float>(*value);
  }
  // Throws FileError with file and line.
  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(file_ + ":" + std::to_string(line_) + ": " + why);
  }

 private:
  std::string_view line() {
    const std::string_view found = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(std::min(found.size() + 1, rest_.size()));
    ++line_;
    return found.substr(0, comment_ == 0 ? found.size() : found.find(comment_));
  }

  std::string file_;
  std::string_view rest_;
  char comment_;
  long line_ = 0;
  std::vector<std::string_view> words_;
};

//   facet normal nx ny nz / outer loop / vertex x y z (three times) / endloop / endfacet
TriangleMesh read_stl_text(const std::string& file, std::string_view text) {
  MeshWords in(file, text, 0);
  Gatherer mesh;
  bool in_solid = false;
  const auto expect = [&](const std::string& all) {
    if (!in.next()) in.refuse("the file ends, but \"" + all + "\" is expected");
    std::size_t k = 0;
    for (const std::string& word : split_at(' ', all))
      if (k >= in.words().size() || !same_word(in.words()[k++], word)) in.refuse("\"" + all + "\" is expected here");
  };
  while (in.next()) {
    const std::string_view word = in.words().front();
    if (same_word(word, "solid") && !in_solid) {
      in_solid = true;
    } else if (same_word(word, "endsolid") && in_solid) {
      in_solid = false;
    } else if (same_word(word, "facet") && in_solid) {
      if (mesh.n_triangles() == kMostTriangles) in.refuse(too_many_triangles());
      expect("outer loop");
      std::array<Corner, 3> corners{};
      for (Corner& corner : corners) {
        expect("vertex");
        if (in.words().size() != 4) in.refuse("a vertex needs three numbers");
        corner = {in.number(1), in.number(2), in.number(3)};
      }
      expect("endloop"), expect("endfacet");
      mesh.add(corners[0], corners[1], corners[2]);
    } else {
      in.refuse("found \"" + std::string(word.substr(0, 40)) + "\", expected " +
                (in_solid ? "\"facet\" or \"endsolid\"" : "\"solid\""));
    }
  }
  if (in_solid) in.refuse("the file ends before \"endsolid\", so it is incomplete; write it again");
  return mesh.take();
}

// 80 bytes of any text, the number of triangles, and of each its normal, three corners and two bytes; little endian.
TriangleMesh read_stl_binary(const std::string& file, std::string_view bytes, std::uint32_t n) {
  static_assert(std::endian::native == std::endian::little);
  if (bytes.size() < kStlHead)
    throw FileError(file + ": it has " + std::to_string(bytes.size()) + " bytes; a binary STL has at least " +
                    std::to_string(kStlHead) + ", a text STL begins with \"solid\"");
  const std::size_t needed = kStlHead + kStlTriangle * std::size_t{n};
  if (needed != bytes.size())
    throw FileError(file + ": it declares " + std::to_string(n) + " triangles (" + std::to_string(needed) +
                    " bytes) but has " + std::to_string(bytes.size()) + " bytes; it is incomplete or not an STL file");
  if (n > kMostTriangles) throw FileError(file + ": " + too_many_triangles());
  Gatherer mesh;
  for (std::uint32_t k = 0; k < n; ++k) {
    std::array<Corner, 3> corners;
    std::memcpy(corners.data(), bytes.data() + kStlHead + kStlTriangle * k + 12, sizeof corners);
    for (const Corner& corner : corners)
      if (!std::ranges::all_of(corner, [](float x) { return std::isfinite(x); }))
        throw FileError(file + ": triangle " + std::to_string(k + 1) + " of " + std::to_string(n) +
                        " has a corner that is not a finite number");
    mesh.add(corners[0], corners[1], corners[2]);
  }
  return mesh.take();
}

// Some programs begin binary files with "solid", too: the size decides.
TriangleMesh read_stl(const std::string& file, std::string_view bytes) {
  std::uint32_t n = 0;
  if (bytes.size() >= kStlHead) std::memcpy(&n, bytes.data() + kStlHead - 4, 4);
  const bool sized = bytes.size() >= kStlHead && bytes.size() == kStlHead + kStlTriangle * std::size_t{n};
  const std::string_view shown = text::trimmed(bytes.substr(0, 200), " \t\r\n");
  const bool is_text = shown.size() >= 5 && same_word(shown.substr(0, 5), "solid") &&
                       bytes.substr(0, 2000).find('\0') == std::string_view::npos;
  return is_text && !sized ? read_stl_text(file, bytes) : read_stl_binary(file, bytes, n);
}

// Number of a corner "7", "7/2", "7//3" or "-1": from 1, or from the last point backwards.
std::uint32_t corner_of(const MeshWords& in, std::string_view word, std::size_t n_points) {
  const long k = number_in<long>(word.substr(0, word.find('/'))).value_or(0);
  const auto n = static_cast<long>(n_points);
  if (k == 0 || k > n || k < -n)
    in.refuse("the corner \"" + std::string(word.substr(0, 40)) + "\" is not among the " + std::to_string(n) +
              " points before it");
  return static_cast<std::uint32_t>(k > 0 ? k - 1 : n + k);
}

// Points "v x y z" and polygons "f a b c ..."; normals, textures, groups and materials are ignored.
TriangleMesh read_obj(const std::string& file, std::string_view text) {
  static constexpr std::array<std::string_view, 13> kReadOver{"vn", "vt", "vp",     "g",      "o",      "s",  "l",
                                                              "p",  "mg", "usemtl", "mtllib", "usemap", "lod"};
  MeshWords in(file, text, '#');
  Gatherer mesh;
  std::vector<Corner> points;  // of the file
  while (in.next()) {
    const std::vector<std::string_view>& words = in.words();
    if (words[0] == "v") {
      if (words.size() < 4) in.refuse("a point needs three numbers");
      points.push_back({in.number(1), in.number(2), in.number(3)});
    } else if (words[0] == "f") {
      if (words.size() < 4) in.refuse("a polygon needs at least three corners");
      const Corner first = points[corner_of(in, words[1], points.size())];
      Corner last = points[corner_of(in, words[2], points.size())];
      for (std::size_t k = 3; k < words.size(); ++k) {
        if (mesh.n_triangles() == kMostTriangles) in.refuse(too_many_triangles());
        const Corner next = points[corner_of(in, words[k], points.size())];
        mesh.add(first, last, next);
        last = next;
      }
    } else if (std::ranges::find(kReadOver, words[0]) == kReadOver.end()) {
      in.refuse("\"" + std::string(words[0].substr(0, 40)) +
                "\" is not read; an OBJ file here has points \"v\" and polygons \"f\"");
    }
  }
  return mesh.take();
}

std::string bytes_of_mesh(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw FileError(file + ": " +
                    (std::filesystem::exists(file, error) ? "it is not a file" : "there is no such file") +
                    "; check the path, which is relative to the scene's folder");
  if (std::filesystem::file_size(file, error) > kMostBytes && !error)
    throw FileError(file + ": it is larger than 64 MB; make the mesh coarser, for example with MeshLab or Blender");
  std::ifstream in(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!in || in.bad()) throw FileError(file + ": it cannot be read; check its permissions");
  return bytes;
}

}  // namespace

TriangleMesh read_mesh(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (!same_word(ending, ".stl") && !same_word(ending, ".obj"))
    throw FileError(file + ": \"" + ending + "\" is not a known mesh format; save it as .stl or .obj");
  const std::string bytes = bytes_of_mesh(file);
  TriangleMesh mesh = same_word(ending, ".stl") ? read_stl(file, bytes) : read_obj(file, bytes);
  if (mesh.triangles.empty()) throw FileError(file + ": it has no triangle with an area; check the file");
  return mesh;
}

struct MeshFiles::Shared {
  std::mutex reading;
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes;  // by file
};

MeshFiles::MeshFiles() : shared_(std::make_shared<Shared>()) {}

std::shared_ptr<const TriangleMesh> MeshFiles::read(const std::string& file) const {
  const std::scoped_lock lock(shared_->reading);
  std::shared_ptr<const TriangleMesh>& mesh = shared_->meshes[file];
  if (mesh == nullptr) mesh = std::make_shared<const TriangleMesh>(read_mesh(file));
  return mesh;
}

}  // namespace lockstep
