// SPDX-License-Identifier: BSD-3-Clause
// Robots in URDF become scenes: the same motion as the robot written by hand, and every mistake by name.
#include "framework/tools/import/urdf.h"
#include "framework/description/scene/system_of.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <Eigen/Geometry>
#include "framework/description/scene/json.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"

namespace urdf_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

// Two arms: the frame of the second is turned, its centre is off its frame, its inertia has axes of its own; a tip without
// mass is fixed to it, and a load to the tip.
const std::string kArms = R"(<?xml version="1.0"?>
<robot name="two arms">
  <material name="blue"><color rgba="0 0.4470588 0.6980392 1"/></material>
  <link name="world"/>
  <link name="upper">
    <inertial><origin xyz="0.5 0 0"/><mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.2"/></inertial>
    <visual><geometry><box size="1 0.1 0.1"/></geometry><material name="blue"/></visual>
  </link>
  <link name="lower">
    <inertial><origin xyz="0.3 0.1 0" rpy="0.2 -0.3 0.5"/><mass value="1"/>
      <inertia ixx="0.02" ixy="0.001" ixz="-0.002" iyy="0.05" iyz="0.003" izz="0.06"/></inertial>
  </link>
  <link name="tip"/>
  <link name="load"><inertial><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial></link>
  <joint name="shoulder" type="continuous"><parent link="world"/><child link="upper"/><origin xyz="0 0 2"/><axis xyz="0 1 0"/>
    <dynamics damping="0.3"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="1 0 0" rpy="0.4 0.2 -0.7"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="wrist" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="0.8 0 0"/></joint>
  <joint name="grip" type="fixed"><parent link="tip"/><child link="load"/><origin xyz="0 0 0.1" rpy="0 0 1.5"/></joint>
</robot>)";

// The last row of a run of 0.4 s.
std::vector<double> last_of(System& system, const std::vector<std::string>& channels) {
  Simulation run(system, {.integrator = "dop853", .tolerance = 1e-12, .output = 0.1});
  std::vector<Request> requests(channels.begin(), channels.end());
  const Table& table = run.record(requests);
  run.run_until(0.4);
  std::vector<double> all;
  for (const std::string& channel : channels) all.push_back(table.last(channel));
  return all;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  REQUIRE(text.find(what) != std::string::npos);
  return text.replace(text.find(what), what.size(), by);
}

}  // namespace

TEST_CASE("a robot in URDF moves as the same robot in C++", "[unit][scene]") {
  const ImportedRobot robot = read_urdf(kArms, "arms.urdf", false);
  CHECK(robot.left_out == std::vector<std::string>{"limits of effort: 'elbow'", "limits of velocity: 'elbow'"});
  Mechanism m = build_mechanism(scene_from_text(write_json(robot.scene), "arms.json"), builtin_registry());
  const std::vector<std::string> channels{"shoulder.rz", "elbow.rz", "shoulder.force_on_p_world_z"};
  const std::vector<double> imported = last_of(system_of(m), channels);

  // By hand: each turn as a rotation matrix.
  const auto rpy = [](double r, double p, double y) -> Mat3 {
    return (Eigen::AngleAxisd(y, Vec3::UnitZ()) * Eigen::AngleAxisd(p, Vec3::UnitY()) *
            Eigen::AngleAxisd(r, Vec3::UnitX()))
        .toRotationMatrix();
  };
  const Mat3 R = rpy(0.4, 0.2, -0.7), A = rpy(0.2, -0.3, 0.5);
  Mat3 J;
  J << 0.02, 0.001, -0.002, 0.001, 0.05, 0.003, -0.002, 0.003, 0.06;
  const Vec3 elbow(1, 0, 2);
  System system({.gravity = {0, 0, -9.81}});
  const auto quaternion = [](const Mat3& M) {
    const Eigen::Quaterniond e(M);
    return Quat{e.w(), e.x(), e.y(), e.z()};
  };
  Body& upper = system.add_body("upper", {2, Vec3::Zero(), Vec3(0.01, 0.2, 0.2).asDiagonal()}, {Vec3(0.5, 0, 2), {}});
  // One body of lower and load, by the theorem of Steiner, in axes of the world at the start.
  const Vec3 c1 = elbow + R * Vec3(0.3, 0.1, 0), c2 = elbow + R * (Vec3(0.8, 0, 0) + Vec3(0, 0, 0.1));
  const Vec3 c = (c1 + 0.5 * c2) / 1.5;
  const auto steiner = [](double mass, const Vec3& d) -> Mat3 {
    return mass * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
  };
  const Mat3 W =
      R * A * J * A.transpose() * R.transpose() + steiner(1, c1 - c) + 0.001 * Mat3::Identity() + steiner(0.5, c2 - c);
  Body& lower = system.add_body("lower", {1.5, Vec3::Zero(), W}, {c, {}});
  const auto axis_frame = [&](const Vec3& z, const Vec3& at) {
    return Pose{at, quaternion(Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), z).toRotationMatrix())};
  };
  const Pose at = axis_frame(Vec3::UnitY(), {0, 0, 2});
  system.add<Revolute>("shoulder", upper, system.ground(), at);
  Marker &p = system.add_marker("p", upper, Pose{{-0.5, 0, 0}, at.q}), &q = system.add_marker("q", system.ground(), at);
  system.add<Revolute>("elbow", lower, upper, axis_frame(R * Vec3::UnitZ(), elbow));
  system.add<TorsionSpringDamper>("damping", p, q, TorsionSpringDamper::Options{.damping = 0.3});
  const std::vector<double> by_hand = last_of(system, channels);
  for (std::size_t k = 0; k < channels.size(); ++k) {
    INFO(channels[k]);
    CHECK(std::abs(imported[k]) > 0.05);
    CHECK(imported[k] == Approx(by_hand[k]).epsilon(1e-9));
  }
}

TEST_CASE("limits, colours and the first link of a robot in URDF", "[unit][scene]") {
  const ImportedRobot robot = read_urdf(kArms, "arms.urdf", false);
  const std::string text = write_json_line(robot.scene);
  CHECK(text.find(R"("stops": [{"axis": "rz", "low": -1, "high": 1.5}])") != std::string::npos);
  CHECK(text.find("\"color\": \"#0072b2\"") != std::string::npos);
  CHECK(text.find("\"s\": \"ground\"") != std::string::npos);

  const std::string heavy = replaced(kArms, "<link name=\"world\"/>",
                                     "<link name=\"world\"><inertial><mass value=\"9\"/><inertia ixx=\"1\" ixy=\"0\" "
                                     "ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>");
  const Registry registry = builtin_registry();
  const auto freedoms = [&](const ImportedRobot& r) {
    Mechanism m = build_mechanism(scene_from_text(write_json(r.scene), "robot.json"), registry);
    system_of(m).setup();
    return m.system.n_slots();
  };
  CHECK(freedoms(read_urdf(heavy, "arms.urdf", false)) == 2);
  CHECK(freedoms(read_urdf(heavy, "arms.urdf", true)) == 3);
}

TEST_CASE("errors of a robot in URDF are named", "[unit][scene]") {
  const auto said = [](const std::string& text) {
    return message_of<SceneError>([&] { read_urdf(text, "arms.urdf", false); });
  };
  check_words(said("<robot name='a'><link name='b'></robot>"), {"arms.urdf:1", "invalid XML"});
  check_words(said("<mujoco/>"), {"arms.urdf", "no <robot>", "xacro"});
  check_words(said("<robot name='a'/>"), {"no <link>"});
  check_words(said(replaced(kArms, "type=\"continuous\"", "type=\"ball\"")), {"shoulder", "ball", "continuous"});
  check_words(said(replaced(kArms, "<child link=\"lower\"/>", "<child link=\"lowr\"/>")), {"elbow", "lowr"});
  check_words(said(replaced(kArms, "<mass value=\"2\"/>", "<mass value=\"two\"/>")), {"upper", "mass", "two"});
  check_words(said(replaced(kArms, "<mass value=\"2\"/>", "<mass value=\"0\"/>")), {"upper", "no mass"});
  check_words(said(replaced(kArms, "<parent link=\"world\"/>", "<parent link=\"load\"/>")), {"closed loop"});
  check_words(said(replaced(kArms, "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>")), {"shoulder", "axis"});
  check_words(said(replaced(kArms, "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1\"/>")), {"shoulder", "axis", "3 numbers"});
  const std::string mesh = replaced(kArms, "<box size=\"1 0.1 0.1\"/>", "<mesh filename=\"upper.stl\"/>");
  const ImportedRobot robot = read_urdf(mesh, "arms.urdf", false);
  CHECK(robot.left_out.back() == "meshes: 'upper'");
  const std::string twice = replaced(kArms, "name=\"grip\"", "name=\"wrist\"");
  check_words(said(twice), {"joint 'wrist'", "twice"});
  check_words(said(replaced(kArms, "izz=\"0.06\"", "izz=\"0.6\"")), {"lower", "inertia"});
  std::string deep = "<robot>";
  for (int k = 0; k < 300000; ++k) deep += "<a>";
  check_words(said(deep), {"nested"});
  for (const char* name : {"r\xff", "r\xc3(", "r\xe2\x82(", "r\xf0\x9f\x98("})
    check_words(said("<robot name='" + std::string(name) + "'/>"), {"UTF-8"});
  CHECK_NOTHROW(
      read_urdf(replaced(kArms, "<child link=\"tip\"/>", "<child link=\"tip\"/><axis xyz=\"0 0 0\"/>"), "a", false));
}

TEST_CASE("a robot that is no tree, or has impossible sizes, is rejected by name", "[unit][scene]") {
  const auto robot = [](const std::string& visual, const std::string& mass, const std::string& joints) {
    return message_of<SceneError>([&] {
      read_urdf("<robot name='r'><link name='a'/><link name='b'>" + visual + "<inertial><mass value='" + mass +
                    "'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>" + joints +
                    "</robot>",
                "r.urdf", false);
    });
  };
  const auto picture = [](const std::string& shape) { return "<visual><geometry>" + shape + "</geometry></visual>"; };
  const std::string joint = "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>",
                    back = "<joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint>";
  CHECK(robot("", "1", joint) == "no error");
  check_words(robot("", "-1", joint), {"r.urdf: link 'b': its mass is negative"});
  check_words(robot(picture("<cylinder radius='0' length='1'/>"), "1", joint),
              {"link 'b', visual, radius: it must be above 0"});
  check_words(robot(picture("<box size='1 0 1'/>"), "1", joint), {"link 'b', visual, size: all edges must be above 0"});
  check_words(robot("", "1", ""), {"several root links, and URDF needs one: 'a' and 'b'"});
  check_words(robot("", "1", joint + back), {"its joints form a closed loop"});
  check_words(robot("", "1", joint + "<joint name='two' type='fixed'><parent link='a'/><child link='b'/></joint>"),
              {"link 'b' is the child of two joints, 'j' and 'two'"});
  check_words(robot("", "1", "<joint name='j' type='fixed'><child link='b'/></joint>"),
              {"joint 'j': it has no <parent>"});
  check_words(robot(picture("<box size='1 1 1 1'/>"), "1", joint), {"size: \"1 1 1 1\" is more than 3 numbers"});
  check_words(robot("<inertial><mass value='2'/></inertial>", "1", joint),
              {"link 'b': it has a mass and no <inertia>", "give it one"});
}

// A base and an arm on a hinge, with more elements in the robot, in the arm and in its hinge.
std::string arm_with(const std::string& in_robot, const std::string& in_link = "", const std::string& in_joint = "") {
  return "<robot name='r'><link name='base'/><link name='arm'><inertial><mass value='1'/><inertia ixx='1' ixy='0' "
         "ixz='0' iyy='1' iyz='0' izz='1'/></inertial>" +
         in_link + "</link><joint name='hinge' type='continuous'><parent link='base'/><child link='arm'/>" + in_joint +
         "</joint>" + in_robot + "</robot>";
}

TEST_CASE("elements of a robot that are not used are listed by kind, on every level", "[unit][scene]") {
  const auto left_out = [](const std::string& text) { return read_urdf(text, "r.urdf", false).left_out; };
  using Lines = std::vector<std::string>;
  CHECK(left_out(arm_with("")).empty());
  CHECK(left_out(arm_with("<gazebo reference='arm'><mu1>0.2</mu1></gazebo><gazebo reference='base'/><gazebo/>"
                          "<gazebo reference='arm'/><sensor name='camera'><ray/></sensor>")) ==
        Lines{"<gazebo>: 'arm', 'base', 'r' and 1 more", "<sensor>: 'camera'"});
  CHECK(left_out(arm_with("", "<self_collide>1</self_collide>", "<safety_controller k_velocity='1'/><calibration/>")) ==
        Lines{"<calibration>: 'hinge'", "<safety_controller>: 'hinge'", "<self_collide>: 'arm'"});
  CHECK(left_out(arm_with("", "<visual><geometry><capsule radius='1'/></geometry><verbose/></visual>")) ==
        Lines{"<capsule>: 'arm'", "<verbose>: 'arm'", "visual shapes: 'arm'"});
  CHECK(left_out(arm_with("<material name='red'><texture filename='a.png'/></material>")) == Lines{"<texture>: 'red'"});
  CHECK(left_out(arm_with("", "<inertial><origin xyz='0 0 0'><note/></origin></inertial>")) ==
        Lines{"further <inertial>: 'arm'"});
  CHECK(left_out(arm_with("", "", "<axis xyz='1 0 0'><note/></axis><axis xyz='0 1 0'/>")) ==
        Lines{"<note>: 'hinge'", "further <axis>: 'hinge'"});
  CHECK(left_out(arm_with("", "<visual><geometry><sphere radius='1'/><box size='1 1 1'/></geometry></visual>")) ==
        Lines{"further <sphere>: 'arm'"});
  // What is left out under a name of its own is listed once, and what it holds is not.
  CHECK(
      left_out(arm_with("<transmission name='t'><joint name='hinge'/><actuator name='m'/></transmission>",
                        "<collision><geometry><box size='1 1 1'/></geometry></collision>", "<mimic joint='hinge'/>")) ==
      Lines{"collision shapes: 'arm'", "mimic relations: 'hinge'", "transmissions: 't'"});
  // Joints that are only named, as in ros2_control and in plugins of Gazebo, hold nothing.
  CHECK(left_out(
            arm_with("<ros2_control name='c'><joint name='hinge'><command_interface name='effort'/></joint>"
                     "</ros2_control><gazebo><plugin name='drive'><left_joint>hinge</left_joint></plugin></gazebo>")) ==
        Lines{"<gazebo>: 'r'", "<ros2_control>: 'c'"});
}

TEST_CASE("joints that a robot holds elsewhere, and misspelt elements, are rejected by name", "[unit][scene]") {
  const auto said = [](const std::string& in_robot, const std::string& in_link = "", const std::string& in_joint = "") {
    return message_of<SceneError>([&] { read_urdf(arm_with(in_robot, in_link, in_joint), "r.urdf", false); });
  };
  check_words(said("<loop_joint name='close' type='continuous'><link1 link='arm'/><link2 link='base'/></loop_joint>"),
              {"r.urdf: <loop_joint> 'close'", "joint", "--without loop_joint"});
  check_words(said("<constraint name='c' type='spherical'/>"), {"<constraint> 'c'", "--without constraint"});
  check_words(
      said("<gazebo><joint name='back' type='revolute'><parent>arm</parent><child>base</child></joint></gazebo>"),
      {"<joint> 'back'", "in <gazebo>", "--without joint"});
  check_words(said("", "<own><deep><weld name='w'><link1>arm</link1><link2>base</link2></weld></deep></own>"),
              {"<weld> 'w'", "in <own>", "--without weld"});
  check_words(said("<drake:ball_constraint name='b'/>"),
              {"<drake:ball_constraint> 'b'", "--without drake:ball_constraint"});
  check_words(said("<drake:distance_constraint name='d'/>"), {"<drake:distance_constraint> 'd'"});
  check_words(said("<closure name='e' parent='arm' child='base'/>"), {"<closure> 'e'", "--without closure"});
  check_words(said("<jont name='typo' type='fixed'/>"),
              {"r.urdf: <jont> 'typo'", "did you mean \"joint\"?", "--without jont"});
  check_words(said("", "<visuel/>"), {"<visuel> of 'arm'", "\"visual\"", "--without visuel"});
  check_words(said("", "", "<Axis xyz='1 0 0'/>"), {"<Axis> of 'hinge'", "\"axis\""});
  check_words(said("", "<visual><geometry><spere radius='1'/></geometry></visual>"),
              {"<spere> of 'arm'", "\"sphere\""});
  check_words(said("<material name='red'><colour rgba='1 0 0 1'/></material>"), {"<colour> of 'red'", "\"color\""});
  // All of a file at once.
  check_words(said("<loop_joint name='l'/><jont name='k'/>", "", "<limits/>"), {"loop_joint", "jont", "limits"});
}

TEST_CASE("shapes of a robot's parts move with their bodies", "[unit][scene]") {
  // The tip has no mass: its sphere moves with the lower arm or the load, which are one. The world has a box.
  std::string text =
      replaced(kArms, "<link name=\"world\"/>",
               "<link name=\"world\"><visual><geometry><box size=\"3 3 0.1\"/></geometry></visual></link>");
  text = replaced(text, "<link name=\"tip\"/>",
                  "<link name=\"tip\"><visual><origin xyz=\"0.2 0 0\"/><geometry><sphere radius=\"0.05\"/></geometry>"
                  "</visual></link>");
  text = replaced(
      text, "<link name=\"load\">",
      "<link name=\"load\"><visual><origin rpy=\"0 0 0.5\"/><geometry><mesh filename=\"package://arms/load.stl\" "
      "scale=\"0.001 -0.001 0.001\"/></geometry></visual><visual><geometry><mesh filename=\"other.dae\"/>"
      "</geometry></visual>");
  std::vector<std::string> asked;
  const ImportedRobot robot = read_urdf(text, "arms.urdf", false, [&](const std::string& name) {
    asked.push_back(name);
    return name.ends_with(".stl") ? "cube_text.stl" : "";
  });
  CHECK(asked == std::vector<std::string>{"package://arms/load.stl", "other.dae"});
  CHECK(robot.left_out.back() == "meshes: 'load'");
  const std::string folder = std::string(paths::kSource) + "/tests/fuzz/corpus/mesh/";
  Mechanism m = build_mechanism(scene_from_text(write_json(robot.scene), folder + "arms.json"), builtin_registry());
  REQUIRE(m.solids.size() == 4);
  const auto world_of = [&](const Solid& solid) { return m.system.body(solid.body).home * solid.at; };
  const auto named = [&](Solid::Kind kind, const std::string& body) {
    for (const Solid& solid : m.solids)
      if (solid.kind == kind && (body.empty() || solid.body == body)) return solid;
    FAIL("no such solid");
    return Solid{};
  };
  CHECK(named(Solid::Kind::box, "upper").size == Vec3(1, 0.1, 0.1));
  CHECK(named(Solid::Kind::box, "world").size == Vec3(3, 3, 0.1));
  CHECK(m.system.body("world").fixed);
  // Places in the world by hand: elbow at (1, 0, 2), turned by R; the tip 0.8 along its x, its sphere 0.2 further.
  const Mat3 R = (Eigen::AngleAxisd(-0.7, Vec3::UnitZ()) * Eigen::AngleAxisd(0.2, Vec3::UnitY()) *
                  Eigen::AngleAxisd(0.4, Vec3::UnitX()))
                     .toRotationMatrix();
  const Vec3 elbow(1, 0, 2);
  CHECK((world_of(named(Solid::Kind::sphere, "")).x - (elbow + R * Vec3(1, 0, 0))).norm() < 1e-12);
  // The mesh is mirrored along its y: its point (x, y, z) stands at scale (x, -y, z).
  const Solid mesh = named(Solid::Kind::mesh, "load");
  const Pose at = world_of(mesh);
  const Mat3 turned = R * Eigen::AngleAxisd(1.5 + 0.5, Vec3::UnitZ()).toRotationMatrix();
  const Vec3 p(1, 2, 3);
  const Vec3 shown = at.x + rotation(at.q) * Vec3(mesh.size.cwiseProduct(p));
  const Vec3 expected = elbow + R * Vec3(0.8, 0, 0.1) + turned * (0.001 * Vec3(1, -2, 3));
  CHECK((shown - expected).norm() < 1e-12);
}

TEST_CASE("the mesh files of a robot are found next to it and in its package", "[unit][scene]") {
  namespace fs = std::filesystem;
  const fs::path root = fs::temp_directory_path() / ("lockstep_urdf_" + std::to_string(::getpid()));
  for (const char* folder : {"arms/urdf", "arms/meshes", "other/meshes"}) fs::create_directories(root / folder);
  for (const char* file : {"arms/urdf/beside.stl", "arms/meshes/a.stl", "other/meshes/b.stl"})
    std::ofstream(root / file) << "solid\n";
  const std::string folder = (root / "arms/urdf").string();
  CHECK(find_robot_mesh("beside.stl", folder) == (root / "arms/urdf/beside.stl").string());
  CHECK(find_robot_mesh("../meshes/a.stl", folder) == (root / "arms/meshes/a.stl").string());
  CHECK(find_robot_mesh("package://arms/meshes/a.stl", folder) == (root / "arms/meshes/a.stl").string());
  CHECK(find_robot_mesh("package://other/meshes/b.stl", folder) == (root / "other/meshes/b.stl").string());
  CHECK(find_robot_mesh("file://" + (root / "other/meshes/b.stl").string(), folder) ==
        (root / "other/meshes/b.stl").string());
  for (const char* none : {"package://arms/meshes/b.stl", "package://none/a.stl", "package://arms", "package:///",
                           "package://", "none.stl", ""})
    CHECK(find_robot_mesh(none, folder).empty());
  fs::remove_all(root);
}

TEST_CASE("limits of a robot that its zero breaks are left out by name", "[unit][scene]") {
  const ImportedRobot robot = read_urdf(replaced(kArms, "upper=\"1.5\"", "upper=\"-0.5\""), "arms.urdf", false);
  CHECK(robot.left_out.front() == "limits of effort: 'elbow'");
  CHECK(std::count(robot.left_out.begin(), robot.left_out.end(), "limits that exclude the joint's zero: 'elbow'") == 1);
  CHECK(write_json_line(robot.scene).find("stops") == std::string::npos);
}

TEST_CASE("sliders, planes and free links of a robot, and names that a scene cannot have", "[unit][scene]") {
  const std::string link =
      R"(<link name="@"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>)";
  const auto links = [&](std::initializer_list<const char*> names) {
    std::string all;
    for (const char* name : names) all += replaced(link, "@", name);
    return all;
  };
  const std::string robot =
      "<robot name='r'><link name='base'/>" + links({"a.b", "ground", "c"}) +
      R"(<joint name="slide" type="prismatic"><parent link="base"/><child link="a.b"/><axis xyz="0 3 4"/><dynamics damping="2"/></joint>
                               <joint name="free" type="floating"><parent link="base"/><child link="ground"/></joint>
                               <joint name="c" type="planar"><parent link="base"/><child link="c"/><axis xyz="0 0 1"/></joint></robot>)";
  const ImportedRobot imported = read_urdf(robot, "r.urdf", false);
  CHECK(imported.left_out ==
        std::vector<std::string>{"names that changed: 'a.b (a_b)', 'ground (ground_2)', 'c (c_2)'"});
  Mechanism m = build_mechanism(scene_from_text(write_json(imported.scene), "r.json"), builtin_registry());
  Simulation run(system_of(m), {.integrator = "dop853", .tolerance = 1e-12, .output = 0.25});
  const Table& table = run.record({"a_b.y", "a_b.z", "ground_2.z", "c.z"});
  run.run_until(0.5);
  // Along the slide m s'' = -m g 0.8 - 2 s', from rest: s = -(0.8 g/2) (t - (1 - exp(-2 t))/2).
  const double t = 0.5, s = -0.8 * 9.81 / 2 * (t - (1 - std::exp(-2 * t)) / 2);
  CHECK(table.last("a_b.y") == Approx(0.6 * s).epsilon(1e-9));
  CHECK(table.last("a_b.z") == Approx(0.8 * s).epsilon(1e-9));
  CHECK(table.last("ground_2.z") == Approx(-9.81 * t * t / 2).epsilon(1e-9));
  CHECK(std::abs(table.last("c.z")) < 1e-9);
}

}  // namespace urdf_test
