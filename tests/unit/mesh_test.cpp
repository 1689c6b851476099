// SPDX-License-Identifier: BSD-3-Clause
// Meshes for pictures: what is read, by the volume and the area that they enclose, and what is refused.
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/solid.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"

namespace mesh_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;
namespace fs = std::filesystem;

namespace {

const std::string kCorpus = std::string(paths::kSource) + "/tests/fuzz/corpus/mesh/";

// A folder of this test, removed at its end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("lockstep_mesh_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return (path / name).string();
  }
};

Vec3 point(const TriangleMesh& mesh, std::uint32_t k) {
  return {mesh.points[k][0], mesh.points[k][1], mesh.points[k][2]};
}

// By the theorem of Gauss: a sixth of the sum of the corners' triple products.
double volume(const TriangleMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles) six += point(mesh, a).dot(cross(point(mesh, b), point(mesh, c)));
  return six / 6;
}
double area(const TriangleMesh& mesh) {
  double two = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    two += cross(Vec3(point(mesh, b) - point(mesh, a)), Vec3(point(mesh, c) - point(mesh, a))).norm();
  return two / 2;
}

std::string contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// An STL with n triangles, all of them zero.
std::string header(std::uint32_t n) {
  std::string head(84, ' ');
  std::memcpy(head.data() + 80, &n, 4);
  return head;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  REQUIRE(text.find(what) != std::string::npos);
  return text.replace(text.find(what), what.size(), by);
}

}  // namespace

TEST_CASE("a cube as binary STL, as STL text and as OBJ is the same cube", "[unit][scene]") {
  for (const char* name : {"cube_binary.stl", "cube_text.stl", "cube.obj"}) {
    INFO(name);
    const TriangleMesh cube = read_mesh(kCorpus + name);
    CHECK(cube.points.size() == 8);
    CHECK(cube.triangles.size() == 12);
    CHECK(volume(cube) == 1);
    CHECK(area(cube) == 6);
  }
}

TEST_CASE("meshes written by other programs are read", "[unit][scene]") {
  const Folder folder;
  // Windows line ends, capitals, a triangle without an area, a second solid, tabs.
  const std::string facet =
      "FACET NORMAL 0 0 1\r\nOUTER LOOP\r\n\tVERTEX 0 0 0\r\n\tVERTEX 2 0 0\r\n\tVERTEX 0 3 -0\r\n"
      "ENDLOOP\r\nENDFACET\r\n";
  const std::string flat = replaced(facet, "2 0 0", "0 0 0");
  const TriangleMesh two = read_mesh(
      folder.write("A.STL", "SOLID a b\r\n" + facet + flat + "ENDSOLID\r\nSOLID b\r\n" + facet + "ENDSOLID b\r\n"));
  CHECK(two.triangles.size() == 2);
  CHECK(two.points.size() == 3);
  CHECK(area(two) == 6);
  // A polygon of five corners, colours behind points, groups, a loose point, numbers of textures.
  const TriangleMesh five = read_mesh(folder.write("five.obj",
                                                   "g all\nv 0 0 0 1 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0 # corner\nv 0 2 "
                                                   "0\nv 9 9 9\nusemtl red\nf 1/1 2/2/2 3//3 4 5\n"));
  CHECK(five.triangles.size() == 3);
  CHECK(five.points.size() == 5);
  CHECK(area(five) == 5);
  // Triangles of which two corners are one point are left out, whichever two.
  const TriangleMesh one =
      read_mesh(folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 2\nf 2 1 2\n"));
  CHECK(one.triangles.size() == 1);
}

TEST_CASE("damaged meshes are rejected with file and line", "[unit][scene]") {
  const Folder folder;
  const auto said = [&](const std::string& name, const std::string& text) {
    const std::string file = folder.write(name, text);
    return message_of<FileError>([&] { read_mesh(file); });
  };
  const std::string text = contents(kCorpus + "cube_text.stl"), binary = contents(kCorpus + "cube_binary.stl");
  check_words(said("cut.stl", text.substr(0, text.find("endloop"))), {"cut.stl:7", "the file ends, but \"endloop\""});
  check_words(said("end.stl", replaced(text, "endsolid cube\n", "")), {"end.stl:85", "endsolid", "incomplete"});
  check_words(said("first.stl", "solid a\nvertex 1 2 3\n"),
              {"first.stl:2", "found \"vertex\", expected \"facet\" or \"endsolid\""});
  check_words(said("word.stl", replaced(text, "outer loop", "outer lop")), {"word.stl:3", "outer loop"});
  check_words(said("nan.stl", replaced(text, "vertex 0", "vertex nan")), {"nan.stl:4", "\"nan\"", "not a number"});
  check_words(said("huge.stl", replaced(text, "vertex 0", "vertex 1e99")), {"huge.stl:4", "1e99"});
  check_words(said("two.stl", replaced(text, "vertex 0 0 0e0", "vertex 0 0")), {"two.stl:4", "three numbers"});
  check_words(said("short.stl", binary.substr(0, binary.size() - 1)), {"short.stl", "12 triangles", "684", "683"});
  check_words(said("tiny.stl", "abc"), {"tiny.stl", "3 bytes", "84"});
  check_words(said("many.stl", header(0xffffffff)), {"many.stl", "4294967295 triangles"});
  std::string not_finite = binary;
  not_finite[84 + 50 + 12 + 3] = '\x7f', not_finite[84 + 50 + 12 + 2] = '\x80';  // infinity, in the second triangle
  check_words(said("inf.stl", not_finite), {"inf.stl", "triangle 2 of 12"});
  check_words(said("none.stl", "solid a\nendsolid a\n"), {"none.stl", "no triangle"});
  check_words(said("flat.stl", header(1) + std::string(50, '\0')), {"flat.stl", "no triangle"});
  check_words(said("corner.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), {"corner.obj:4", "\"4\"", "3 points"});
  check_words(said("tail.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3x\n"), {"tail.obj:4", "\"3x\""});
  check_words(said("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"), {"zero.obj:4", "\"0\""});
  check_words(said("early.obj", "f 1 2 3\n"), {"early.obj:1", "0 points"});
  check_words(said("few.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), {"few.obj:3", "three corners"});
  check_words(said("free.obj", "v 0 0 0\ncstype bezier\n"), {"free.obj:2", "cstype"});
  check_words(said("robot.dae", "<COLLADA/>"), {"robot.dae", ".dae", ".stl or .obj"});
  check_words(message_of<FileError>([&] { read_mesh((folder.path / "none.obj").string()); }),
              {"there is no such file"});
  fs::create_directories(folder.path / "folder.stl");
  check_words(message_of<FileError>([&] { read_mesh((folder.path / "folder.stl").string()); }), {"it is not a file"});
}

TEST_CASE("meshes that are too large are rejected before they are read", "[unit][scene]") {
  const Folder folder;
  const std::string many = folder.write("many.stl", header(1'000'001));
  fs::resize_file(many, 84 + 50ULL * 1'000'001);
  check_words(message_of<FileError>([&] { read_mesh(many); }), {"more than 1000000 triangles", "coarser"});
  const std::string large = folder.write("large.obj", "v 0 0 0\n");
  fs::resize_file(large, (64ULL << 20) + 1);
  check_words(message_of<FileError>([&] { read_mesh(large); }), {"larger than 64 MB"});
}

TEST_CASE("shapes for drawing only are at their places in the scene", "[unit][scene]") {
  const Folder folder;
  fs::copy_file(kCorpus + "cube_text.stl", folder.path / "cube.stl");
  const Registry registry = builtin_registry();
  const auto built = [&](const std::string& visual) {
    const std::string file = (folder.path / "scene.json").string();
    return build_mechanism(
        scene_from_text(R"({"lockstep": 1, "bodies": [{"name": "ball", "sphere": {"mass": 2, "radius": 0.5},
                           "position": [7, 8, 9], "visual": )" +
                            visual + "}]}",
                        file),
        registry);
  };
  const Mechanism m = built(R"({"shapes": [
      {"box": {"size": [1, 2, 3]}, "at": [1, 0, 0], "orientation": {"axis": "z", "angle": "90 deg"}},
      {"rod": {"from": [0, 0, 1], "to": [0, 0, 3], "radius": "10 mm"}, "at": [0, 1, 0]},
      {"cylinder": {"radius": 0.2, "length": 4}}, {"sphere": {"radius": 1.5}},
      {"mesh": "cube.stl", "scale": -0.5, "at": [0, 0, "20 mm"]}, {"mesh": "cube.stl"}]})");
  REQUIRE(m.solids.size() == 7);
  CHECK(m.system.body("ball").mass.mass == 2);  // pictures weigh nothing
  for (const Solid& solid : m.solids) CHECK(solid.body == "ball");
  CHECK(m.solids[1].size == Vec3(1, 2, 3));
  CHECK((m.solids[1].at.x - Vec3(1, 0, 0)).norm() == 0);
  CHECK((rotation(m.solids[1].at.q) * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm() < 1e-15);
  CHECK((m.solids[2].size - Vec3(0.02, 0.02, 2)).norm() < 1e-15);
  CHECK((m.solids[2].at.x - Vec3(0, 1, 2)).norm() < 1e-15);
  CHECK((rotation(m.solids[2].at.q).col(2).cwiseAbs() - Vec3(0, 0, 1)).norm() < 1e-15);
  CHECK(m.solids[3].size == Vec3(0.4, 0.4, 4));
  CHECK(m.solids[4].size == Vec3(3, 3, 3));
  CHECK(m.solids[5].kind == Solid::Kind::mesh);
  CHECK(m.solids[5].size == Vec3(-0.5, -0.5, -0.5));
  CHECK(m.solids[5].at.x == Vec3(0, 0, 0.02));
  CHECK(volume(*m.solids[5].mesh) == 1);
  CHECK(m.solids[5].mesh == m.solids[6].mesh);  // read once
  CHECK(built(R"({"own_shape": false, "shapes": [{"mesh": "cube.stl"}]})").solids.size() == 1);
  CHECK(built(R"({"own_shape": false})").solids.empty());

  const auto refused = [&](const std::string& shape, std::initializer_list<const char*> words) {
    const std::string said = message_of<SceneError>([&] { built(R"({"shapes": [)" + shape + "]}"); });
    INFO(said);
    check_words(said, {"scene.json:2", "body 'ball', visual.shapes[0]"});
    for (const char* word : words) CHECK(said.find(word) != std::string::npos);
  };
  refused("{}", {"it has no shape", "\"mesh\""});
  refused(R"({"mesh": "cube.stl", "box": {"size": [1, 1, 1]}})", {"two shapes"});
  refused(R"({"mesh": "none.stl"})", {"none.stl", "no such file"});
  refused(R"({"mesh": "cube.stl", "scale": 0})", {"scale", "0.001"});
  refused(R"({"sphere": {"radius": 1}, "scale": 2})", {"scale", "remove"});
  refused(R"({"sphere": {"radius": 1, "mass": 2}})", {"has no mass", "mass"});
  refused(R"({"sphere": {"radius": 0}})", {"radius", "greater than 0"});
  refused(R"({"box": {"size": [1, 0, 1]}})", {"size", "greater than 0"});
  refused(R"({"rod": {"from": [1, 0, 0], "to": [1, 0, 0]}})", {"same point"});
  refused(R"({"mesh": "cube.stl", "position": [0, 0, 0]})", {"position", "orientation"});
}

TEST_CASE("runs of a sweep share the meshes that were read", "[unit][scene]") {
  const Folder folder;
  fs::copy_file(kCorpus + "cube_text.stl", folder.path / "cube.stl");
  const Registry registry = builtin_registry();
  const Scene scene = scene_from_text(
      R"({"lockstep": 1, "bodies": [{"name": "ball", "sphere": {"mass": 2, "radius": 0.5},
          "visual": {"shapes": [{"mesh": "cube.stl"}]}}]})",
      (folder.path / "scene.json").string());
  const auto mesh_of = [&](const Scene& s) { return build_mechanism(s, registry).solids.back().mesh; };
  const auto mesh = mesh_of(scene);
  const Variable mass = read_variable("bodies.ball.sphere.mass=1,2,3", scene, registry);
  fs::remove(folder.path / "cube.stl");  // nothing reads it again
  CHECK(mesh_of(scene) == mesh);
  CHECK(mesh_of(Scene(scene)) == mesh);
  std::vector<std::shared_ptr<const TriangleMesh>> seen(3);
  {
    std::vector<std::jthread> threads;
    for (std::size_t k = 0; k < 3; ++k)
      threads.emplace_back([&, k] { seen[k] = mesh_of(vary_scene(scene, {mass}, {k}, registry)); });
  }
  CHECK(seen == std::vector(3, mesh));
  CHECK(mesh_of(set_in_scene(scene, {"bodies.ball.sphere.mass=5"}, registry)) == mesh);
}

}  // namespace mesh_test
