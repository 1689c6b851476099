// SPDX-License-Identifier: BSD-3-Clause
// MuJoCo: reduced coordinates from an MJCF text, loops closed by its soft equality "connect", contacts off.
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "tests/benchmark/peers/assemblies.h"
#include "tests/benchmark/peers/measure.h"

using namespace lockstep::peers;

namespace {

/// How stiff the soft closures are.
enum class Stiffness { standard, stiff, stiffest };

struct Method {
  std::string integrator = "Euler";
  Stiffness stiffness = Stiffness::standard;
  double step = 0;
};

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}
std::string numbers(const Vec3& v) { return number(v[0]) + ' ' + number(v[1]) + ' ' + number(v[2]); }

/// A mechanism as MJCF. Its parser refuses more than 100 nested elements, so a long chain goes on in included files.
class Document {
 public:
  Document(const Mechanism& m, const Method& method) : mechanism_(m), method_(method) {
    build();
    // pieces come as a0 | a1 | ... | b1 | b0: file i is a_i + b_i
    const std::size_t n = pieces_.size() / 2 + 1;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t closing = pieces_.size() - 1 - i;
      std::string text = pieces_[i] + (closing == i ? "" : pieces_[closing]);
      if (i > 0) text = "<mujocoinclude>" + text + "</mujocoinclude>";
      files.emplace_back(i > 0 ? "c" + std::to_string(i) + ".xml" : "m.xml", text);
    }
  }

  std::vector<std::pair<std::string, std::string>> files;  ///< name, text; the first includes the others

 private:
  static constexpr int kNested = 80;

  void write(const std::string& text) { pieces_.back() += text; }

  void build() {
    pieces_.assign(1, "");
    write("<mujoco><compiler angle='radian' coordinate='local' inertiafromgeom='false'/><option timestep='" +
          number(method_.step) + "' gravity='" + numbers(mechanism_.gravity) + "' integrator='" + method_.integrator +
          "' solver='Newton' iterations='200' tolerance='1e-14'>"
          "<flag contact='disable' limit='disable' frictionloss='disable'/></option>"
          "<size nstack='30000000'/><worldbody>");
    if (mechanism_.kind == Kind::chain || mechanism_.kind == Kind::spatial_chain) write_chain();
    if (mechanism_.kind == Kind::four_bars) write_four_bars();
    if (mechanism_.kind == Kind::slider_crank) write_slider_crank();
    if (mechanism_.kind == Kind::heavy_top)
      write("<body name='b0'>" + inertial(mass_of(mechanism_, 0), {0, 1, 0}) + "<joint type='ball'/></body>");
    if (!is_described(mechanism_)) write_assembly(assembly_of(mechanism_));
    write("</worldbody>");
    if (!equalities_.empty()) write("<equality>" + equalities_ + "</equality>");
    if (!tendons_.empty()) write("<tendon>" + tendons_ + "</tendon>");
    if (!actuators_.empty()) write("<actuator>" + actuators_ + "</actuator>");
    write("</mujoco>");
  }

  static std::string inertial(const Mass& m, const Vec3& centre) {
    return "<inertial pos='" + numbers(centre) + "' mass='" + number(m.mass) + "' diaginertia='" + numbers(m.J) + "'/>";
  }
  std::string begin_body(int body, const std::string& place) const {
    return "<body name='b" + std::to_string(body) + "' " + place + ">" +
           inertial(mass_of(mechanism_, body), {half_length(mechanism_, body), 0, 0});
  }
  std::string hinge(const std::string& axis = "0 0 1") const { return "<joint type='hinge' axis='" + axis + "'/>"; }

  void write_chain() {
    for (int k = 0; k < mechanism_.n; ++k) {
      if (k > 0 && k % kNested == 0) {
        write("<include file='c" + std::to_string(k / kNested) + ".xml'/>");
        pieces_.emplace_back();
      }
      write(begin_body(k, k > 0 ? "pos='1 0 0'" : "pos='0 0 0'") +
            hinge(turns_about_y(mechanism_, k) ? "0 1 0" : "0 0 1"));
    }
    for (int k = mechanism_.n - 1; k >= 0; --k) {
      write("</body>");
      if (k > 0 && k % kNested == 0) pieces_.emplace_back();
    }
  }

  // An upright's x axis points up at the start; its bar hangs at its top.
  void write_four_bars() {
    const int n = mechanism_.n;
    const std::string half = number(std::sqrt(0.5));
    for (int k = 0; k <= n; ++k) {
      write(begin_body(k, "pos='" + std::to_string(k) + " 0 0' quat='" + half + " 0 0 " + half + "'") + hinge());
      if (k < n)
        write(begin_body(n + 1 + k, "pos='1 0 0' quat='" + half + " 0 0 -" + half + "'") + hinge() + "</body>");
      write("</body>");
    }
    for (int k = 0; k < n; ++k) connect(n + 1 + k, k + 1, "1 0 0");
  }

  void write_slider_crank() {
    const std::string top = "pos='" + number(kCrank) + " 0 0'";
    write("<body name='b0'>" + inertial(mass_of(mechanism_, 0), {kCrank / 2, 0, 0}) +
          "<joint name='crank' type='hinge' axis='0 0 1'/>" + begin_body(1, top) + hinge() + "</body></body>");
    write(begin_body(2, "pos='" + number(kCrank + kRod) + " 0 0'") + "<joint type='slide' axis='1 0 0'/></body>");
    connect(1, 2, number(kRod) + " 0 0");
    actuators_ = "<velocity joint='crank' kv='1e7'/>";
  }

  // A body's frame is at its mass centre, turned as at the start; its children stand inside its element.
  void write_assembly(const Assembly& assembly) {
    for (const TreeJoint& j : assembly.tree)
      if (j.parent == kGroundBody) write_branch(assembly, j);
    for (std::size_t i = 0; i < assembly.springs.size(); ++i) {
      const Spring& s = assembly.springs[i];
      if (s.b == kGroundBody) write(attachment(assembly, s, i, 'b'));
      tendons_ += "<spatial stiffness='" + number(s.stiffness) + "' damping='" + number(s.damping) +
                  "' springlength='" + number(s.free_length) + "'><site site='s" + std::to_string(i) +
                  "a'/><site site='s" + std::to_string(i) + "b'/></spatial>";
    }
    for (const ClosingJoint& j : assembly.loops)
      for (const double side : {0.3, -0.3})
        if (!j.planar || side > 0) {
          const Vec3 anchor = to_local(assembly, j.a, j.planar ? j.at : Vec3(j.at + side * j.axis));
          connect(j.a, j.b, numbers(anchor));
        }
  }

  static Vec3 to_local(const Assembly& assembly, int body, const Vec3& x) {
    if (body == kGroundBody) return x;
    const AssemblyBody& b = assembly.bodies[body];
    return b.R.transpose() * (x - b.x);
  }
  static std::string attachment(const Assembly& assembly, const Spring& s, std::size_t i, char end) {
    return "<site name='s" + std::to_string(i) + end + "' pos='" +
           numbers(end == 'a' ? to_local(assembly, s.a, s.at_a) : to_local(assembly, s.b, s.at_b)) + "'/>";
  }

  void write_branch(const Assembly& assembly, const TreeJoint& joint) {
    const AssemblyBody& body = assembly.bodies[joint.child];
    const Mat3 R_parent = joint.parent == kGroundBody ? Mat3(Mat3::Identity()) : assembly.bodies[joint.parent].R;
    const Eigen::Quaterniond q(Mat3(R_parent.transpose() * body.R));
    write("<body name='b" + std::to_string(joint.child) + "' pos='" +
          numbers(to_local(assembly, joint.parent, body.x)) + "' quat='" + number(q.w()) + ' ' + numbers(q.vec()) +
          "'>" + inertial(body.mass, Vec3::Zero()) + "<joint type='" + (joint.slides ? "slide" : "hinge") + "' pos='" +
          numbers(to_local(assembly, joint.child, joint.at)) + "' axis='" + numbers(body.R.transpose() * joint.axis) +
          "'/>");
    for (std::size_t i = 0; i < assembly.springs.size(); ++i) {
      if (assembly.springs[i].a == joint.child) write(attachment(assembly, assembly.springs[i], i, 'a'));
      if (assembly.springs[i].b == joint.child) write(attachment(assembly, assembly.springs[i], i, 'b'));
    }
    for (const TreeJoint& j : assembly.tree)
      if (j.parent == joint.child) write_branch(assembly, j);
    write("</body>");
  }

  void connect(int a, int b, const std::string& anchor) {
    equalities_ += "<connect body1='b" + std::to_string(a) + "' body2='" +
                   (b == kGroundBody ? "world" : "b" + std::to_string(b)) + "' anchor='" + anchor;
    if (method_.stiffness != Stiffness::standard) equalities_ += "' solimp='0.9999 0.9999 0.001 0.5 2";
    if (method_.stiffness == Stiffness::stiffest) equalities_ += "' solref='" + number(2 * method_.step) + " 1";
    equalities_ += "'/>";
  }

  const Mechanism& mechanism_;
  const Method& method_;
  std::vector<std::string> pieces_;
  std::string equalities_, actuators_, tendons_;
};

class Model {
 public:
  Model(const Mechanism& m, const Method& method) : mechanism_(m) {
    load(Document(m, method));
    if (m.kind == Kind::four_bars)
      for (int k = 0; k <= 2 * m.n; ++k) data->qvel[velocity_of(k)] = k <= m.n ? -1 : 1;
    if (m.kind == Kind::slider_crank) {
      data->qvel[velocity_of(0)] = data->ctrl[0] = kCrankSpeed;
      data->qvel[velocity_of(1)] = -kCrankSpeed * kCrank / kRod - kCrankSpeed;
    }
    if (!is_described(m)) {
      const Assembly assembly = assembly_of(m);
      for (const TreeJoint& j : assembly.tree) data->qvel[velocity_of(j.child)] = j.speed;
      if (assembly.torque != 0) data->qfrc_applied[velocity_of(0)] = assembly.torque;
    }
    if (m.kind == Kind::heavy_top)
      for (int i = 0; i < 3; ++i) data->qvel[i] = kTopSpin[i];
  }
  ~Model() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  Motions motions() {
    mj_kinematics(model, data);
    mj_comPos(model, data);
    mj_comVel(model, data);
    Motions bodies(static_cast<std::size_t>(n_bodies(mechanism_)));
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const int i = id(static_cast<int>(k));
      mjtNum twist[6];
      mj_objectVelocity(model, data, mjOBJ_BODY, i, twist, 0);  // at the mass centre, world axes
      for (int j = 0; j < 3; ++j) {
        bodies[k].x[j] = data->xipos[3 * i + j];
        bodies[k].w[j] = twist[j];
        bodies[k].v[j] = twist[3 + j];
        for (int l = 0; l < 3; ++l) bodies[k].R(j, l) = data->ximat[9 * i + 3 * j + l];
      }
    }
    return bodies;
  }

  mjModel* model = nullptr;
  mjData* data = nullptr;

 private:
  int id(int body) const { return mj_name2id(model, mjOBJ_BODY, ("b" + std::to_string(body)).c_str()); }
  int velocity_of(int body) const { return model->jnt_dofadr[model->body_jntadr[id(body)]]; }

  void load(const Document& document) {
    static mjVFS disk;  // too large for the stack
    mj_defaultVFS(&disk);
    for (const auto& [name, text] : document.files) {
      mj_makeEmptyFileVFS(&disk, name.c_str(), static_cast<int>(text.size()) + 1);
      std::memcpy(disk.filedata[mj_findFileVFS(&disk, name.c_str())], text.c_str(), text.size() + 1);
    }
    char error[500] = "";
    model = mj_loadXML("m.xml", &disk, error, sizeof error);
    mj_deleteVFS(&disk);
    if (!model) throw std::runtime_error(std::string("mj_loadXML: ") + error);
    data = mj_makeData(model);
    if (!data) throw std::runtime_error("mj_makeData");
  }

  const Mechanism& mechanism_;
};

void simulate(Run& run, const Method& method) {
  Model model(run.mechanism, method);
  const long n = n_steps(run.mechanism, method.step);
  if (run.sampled) run.sample(0, model.motions());
  run.start_clock();
  for (long i = 1; i <= n; ++i) {
    mj_step(model.model, model.data);
    if (run.sampled && due(i, n)) run.sample(run.mechanism.until * double(i) / double(n), model.motions());
    if (i % 64 == 0 || n < 64) run.check_time();
  }
  run.stop_clock();
  run.steps = n;
  const auto& warning = model.data->warning;  // after a number that is none it begins anew by itself
  const int reset = warning[mjWARN_BADQPOS].number + warning[mjWARN_BADQVEL].number + warning[mjWARN_BADQACC].number;
  if (reset > 0) {
    run.broken = true;
    run.note = "resets=" + std::to_string(reset);
  }
  if (run.mechanism.kind == Kind::slider_crank)
    run.note += "torque_error=" + std::to_string(model.data->actuator_force[0] - slider_crank_torque());
}

std::string tag(const Mechanism& m, Stiffness stiffness) {
  if (!has_loops(m)) return "";
  return stiffness == Stiffness::standard ? "+soft" : stiffness == Stiffness::stiff ? "+stiff" : "+stiffest";
}

/// Which closures are tried: all on the small ladder, the two ends elsewhere.
std::vector<Stiffness> stiffnesses(const Mechanism& m) {
  if (!has_loops(m)) return {Stiffness::standard};
  if (m.name == "nfourbar-2") return {Stiffness::standard, Stiffness::stiff, Stiffness::stiffest};
  return {Stiffness::standard, Stiffness::stiffest};
}

}  // namespace

int main(int argc, char** argv) {
  Bench bench("mujoco", argc, argv);
  mju_user_warning = [](const char*) {};  // a run that it begins anew is told by its counters
  for (const Mechanism& m : all_mechanisms()) {
    if (!bench.wants(m)) continue;
    for (const std::string integrator : {"RK4", "Euler", "implicit"}) {
      if (integrator == "implicit" && m.n > 10) continue;
      for (const Stiffness stiffness : stiffnesses(m))
        bench.sweep(m, integrator + tag(m, stiffness), step_ladder(m), [=](double h) {
          return [=](Run& run) { simulate(run, {integrator, stiffness, h}); };
        });
    }
  }
}
