// SPDX-License-Identifier: BSD-3-Clause
// Solids and looks: what bodies look like.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/math.h>

namespace lockstep {

/// A surface of triangles, for pictures.
struct TriangleMesh {
  std::vector<std::array<float, 3>> points;             ///< corners, each once
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< their corners, as numbers of points
};

/// Reads a mesh: STL, binary or as text, or the points and polygons of OBJ, by the ending of the file's name. Polygons
/// become fans of triangles; triangles without an area are left out. At most 64 MB and a million triangles. Throws
/// FileError with file and line (of a binary file, the triangle) for what is damaged or too large.
LOCKSTEP_API TriangleMesh read_mesh(const std::string& file);

/// Meshes of files, each read once. Copies share what was read; several threads may read.
class LOCKSTEP_API MeshFiles {
 public:
  MeshFiles();                                       ///< none is read yet
  MeshFiles(const MeshFiles&) = default;             ///< shares what was read; so does what is moved from
  MeshFiles& operator=(const MeshFiles&) = default;  ///< likewise

  /// The mesh of this file, by read_mesh() at the first call. Throws what that throws, at each call.
  std::shared_ptr<const TriangleMesh> read(const std::string& file) const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

/// A solid that a body is made of, for pictures; its mass is in the body's MassProperties.
struct Solid {
  /// The form, about the origin of its frame.
  enum class Kind {
    box,       ///< edges along x, y and z
    cylinder,  ///< axis along z; a rod is one, too
    sphere,    ///< about the origin
    mesh       ///< triangles
  };
  std::string body;          ///< name of the body
  Kind kind = Kind::box;     ///< its form
  Vec3 size = Vec3::Zero();  ///< extent along x, y and z of its frame, m: of a cylinder two diameters and the length;
                             ///< of a mesh the factors on its points
  Pose at{};                 ///< its frame in the body's frame
  std::shared_ptr<const TriangleMesh> mesh{};  ///< of a mesh its surface, else null; many solids may share one
};

/// Colour and opacity of a body in pictures.
struct Look {
  std::string body,    ///< name of the body
      color{};         ///< "#rrggbb"; "": the next of a palette
  double opacity = 1;  ///< 0: glass, 1: solid
};

}  // namespace lockstep
