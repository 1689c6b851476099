// SPDX-License-Identifier: BSD-3-Clause
// SUNDIALS IDA (BDF) on planar maximal coordinates, index 2 stabilised (Gear, Gupta, Leimkuhler):
//   q' = v - G^T mu,  M v' = f - G^T lambda,  0 = G v,  0 = g(q)   (mass-scaled unknowns; mu = 0 on the solution)
// A rod has q (3) and v (3), a joint lambda (2) and mu (2), interleaved along the mechanism, so that the Jacobian is
// banded; it is analytic, its factor a banded LU. The model is ours: it stands for what a general solver can do.
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>

#include "tests/benchmark/peers/measure.h"

using namespace lockstep::peers;

namespace {

/// A pin between body a (or a point of the ground) and body b, at arms along their x axes.
struct Pin {
  int a, b;
  double arm_a, arm_b;
  double x = 0, y = 0;  ///< the ground's point
  int at = 0;           ///< first of its unknowns
};

class Model {
 public:
  explicit Model(const Mechanism& m) : mechanism_(m), at_(static_cast<std::size_t>(n_bodies(m))) {
    if (m.kind == Kind::chain) {
      for (int k = 0; k < m.n; ++k) {
        add_body(k);
        add_pin({k - 1, k, 0.5, -0.5});
      }
    } else {
      for (int k = 0; k <= m.n; ++k) {
        add_body(k);
        add_pin({-1, k, 0, -0.5, double(k)});
        if (k > 0) add_pin({m.n + k, k, 0.5, 0.5});
        if (k < m.n) {
          add_body(m.n + 1 + k);
          add_pin({k, m.n + 1 + k, 0.5, -0.5});
        }
      }
    }
    for (const Pin& p : pins_) {
      for (const int body : {p.a, p.b})
        if (body >= 0) widen({p.at + 3 - at(body), at(body) + 5 - p.at});
      if (p.a >= 0) widen({std::abs(at(p.a) - at(p.b)) + 5});
    }
  }

  int size() const { return n_; }
  int band() const { return band_; }
  const std::vector<Pin>& pins() const { return pins_; }
  bool is_differential(int i) const { return differential_[i]; }

  void start(double* y) const {
    std::fill(y, y + n_, 0.0);
    int k = 0;
    for (const BodyMotion& b : start_of(mechanism_)) {
      double* u = y + at(k++);
      u[0] = b.x[0], u[1] = b.x[1], u[2] = std::atan2(b.R(1, 0), b.R(0, 0));
      u[3] = b.v[0], u[4] = b.v[1], u[5] = b.w[2];
    }
  }

  Motions motions(const double* y) const {
    Motions all;
    for (const int first : at_) {
      const double* u = y + first;
      BodyMotion b;
      b.x = {u[0], u[1], 0};
      b.R << std::cos(u[2]), -std::sin(u[2]), 0, std::sin(u[2]), std::cos(u[2]), 0, 0, 0, 1;
      b.v = {u[3], u[4], 0};
      b.w = {0, 0, u[5]};
      all.push_back(b);
    }
    return all;
  }

  void residual(const double* y, const double* yp, double* r) const {
    for (const int first : at_) {
      const double *u = y + first, *p = yp + first;
      double* o = r + first;
      for (int i = 0; i < 3; ++i) o[i] = p[i] - u[3 + i];
      o[3] = p[3], o[4] = p[4] + kGravity, o[5] = kInertia * p[5];
    }
    for (const Pin& pin : pins_) {
      const double* l = y + pin.at;  // lambda, mu
      double x = -pin.x, z = -pin.y, vx = 0, vz = 0;
      each_arm(pin, y, [&](int first, double side, double c, double s) {
        const double* u = y + first;
        double* o = r + first;
        x += side * (u[0] + c), z += side * (u[1] + s);
        vx += side * (u[3] - s * u[5]), vz += side * (u[4] + c * u[5]);
        o[0] += side * l[2], o[1] += side * l[3], o[2] += side * (c * l[3] - s * l[2]);
        o[3] += side * l[0], o[4] += side * l[1], o[5] += side * (c * l[1] - s * l[0]);
      });
      double* o = r + pin.at;
      o[0] = vx, o[1] = vz, o[2] = x, o[3] = z;
    }
  }

  /// dF/dy + cj dF/dy'; put(i, j, value) adds.
  template <class Put>
  void jacobian(const double* y, double cj, const Put& put) const {
    for (const int o : at_)
      for (int i = 0; i < 3; ++i) {
        put(o + i, o + i, cj);
        put(o + i, o + 3 + i, -1.0);
        put(o + 3 + i, o + 3 + i, cj * (i < 2 ? 1.0 : kInertia));
      }
    for (const Pin& pin : pins_) {
      const double* l = y + pin.at;
      const int t = pin.at;
      each_arm(pin, y, [&](int o, double side, double arm_c, double arm_s) {
        const double c = side * arm_c, s = side * arm_s, w = y[o + 5];
        for (int i = 0; i < 2; ++i) {
          put(o + i, t + 2 + i, side), put(o + 3 + i, t + i, side);
          put(t + i, o + 3 + i, side), put(t + 2 + i, o + i, side);
        }
        put(o + 2, t + 2, -s), put(o + 2, t + 3, c), put(o + 5, t, -s), put(o + 5, t + 1, c);
        put(t, o + 5, -s), put(t + 1, o + 5, c), put(t + 2, o + 2, -s), put(t + 3, o + 2, c);
        put(o + 2, o + 2, -c * l[2] - s * l[3]), put(o + 5, o + 2, -c * l[0] - s * l[1]);
        put(t, o + 2, -c * w), put(t + 1, o + 2, -s * w);
      });
    }
  }

  /// Matrix and right side for the accelerations and lambda at the start: [M G^T; G 0].
  template <class Put>
  void acceleration_system(const double* y, double* right, const Put& put) const {
    std::fill(right, right + n_, 0.0);
    for (const int o : at_) {
      for (int i = 0; i < 3; ++i) {
        put(o + i, o + i, 1.0);
        put(o + 3 + i, o + 3 + i, i < 2 ? 1.0 : kInertia);
        right[o + i] = y[o + 3 + i];
      }
      right[o + 4] = -kGravity;
    }
    for (const Pin& pin : pins_) {
      const int t = pin.at;
      put(t + 2, t + 2, 1.0), put(t + 3, t + 3, 1.0);
      each_arm(pin, y, [&](int o, double side, double arm_c, double arm_s) {
        const double c = side * arm_c, s = side * arm_s, w = y[o + 5];
        for (int i = 0; i < 2; ++i) put(o + 3 + i, t + i, side), put(t + i, o + 3 + i, side);
        put(o + 5, t, -s), put(o + 5, t + 1, c), put(t, o + 5, -s), put(t + 1, o + 5, c);
        right[t] += c * w * w, right[t + 1] += s * w * w;
      });
    }
  }

 private:
  static constexpr double kInertia = 1.0 / 12;

  int at(int body) const { return at_[body]; }
  void add_body(int k) {
    at_[k] = n_;
    n_ += 6;
    differential_.insert(differential_.end(), 6, true);
  }
  void add_pin(Pin p) {
    p.at = n_;
    pins_.push_back(p);
    n_ += 4;
    differential_.insert(differential_.end(), 4, false);
  }
  void widen(std::initializer_list<int> distances) {
    for (const int d : distances) band_ = std::max(band_, std::abs(d));
  }
  /// f(first unknown of the body, sign in the constraint, arm's x, arm's y) for one or both bodies.
  template <class F>
  void each_arm(const Pin& pin, const double* y, const F& f) const {
    const auto arm = [&](int body, double length, double side) {
      const double angle = y[at(body) + 2];
      f(at(body), side, length * std::cos(angle), length * std::sin(angle));
    };
    arm(pin.b, pin.arm_b, 1);
    if (pin.a >= 0) arm(pin.a, pin.arm_a, -1);
  }

  const Mechanism& mechanism_;
  std::vector<int> at_;  // first unknown of each body
  std::vector<Pin> pins_;
  std::vector<bool> differential_;
  int n_ = 0, band_ = 0;
};

/// What is freed at the end.
template <class T, class F>
std::unique_ptr<T, std::function<void(T*)>> owned(T* thing, F&& free_it) {
  if (!thing) throw std::runtime_error("SUNDIALS made nothing");
  return {thing, std::forward<F>(free_it)};
}

double* data(N_Vector v) { return N_VGetArrayPointer(v); }

int residual_of(realtype, N_Vector y, N_Vector yp, N_Vector r, void* model) {
  static_cast<const Model*>(model)->residual(data(y), data(yp), data(r));
  return 0;
}

int jacobian_of(realtype, realtype cj, N_Vector y, N_Vector, N_Vector, SUNMatrix A, void* model, N_Vector, N_Vector,
                N_Vector) {
  static_cast<const Model*>(model)->jacobian(data(y), cj, [&](int i, int j, double x) { SM_ELEMENT_B(A, i, j) += x; });
  return 0;
}

class Solver {
 public:
  Solver(const Mechanism& m, double tolerance)
      : model_(m),
        context_(make_context()),
        y_(vector()),
        yp_(vector()),
        kinds_(vector()),
        weights_(vector()),
        matrix_(owned(SUNBandMatrix(model_.size(), model_.band(), model_.band(), context_.get()), SUNMatDestroy)),
        linear_(owned(SUNLinSol_Band(y_.get(), matrix_.get(), context_.get()),
                      [](SUNLinearSolver s) { SUNLinSolFree(s); })),
        ida_(owned(static_cast<char*>(IDACreate(context_.get())),
                   [](char* ida) {
                     void* memory = ida;
                     IDAFree(&memory);
                   })),
        silent_(owned(std::fopen("/dev/null", "w"), [](FILE* f) { std::fclose(f); })),
        tolerance_(tolerance),
        until_(m.until) {
    model_.start(data(y_.get()));
    N_VConst(0, yp_.get());
    for (int i = 0; i < model_.size(); ++i) {
      data(kinds_.get())[i] = model_.is_differential(i) ? 1 : 0;
      data(weights_.get())[i] = tolerance;
    }
    for (const Pin& pin : model_.pins())  // loose: at index 2 the multipliers amplify round-off by 1/h
      for (int i = 0; i < 4; ++i) data(weights_.get())[pin.at + i] = (i < 2 ? 1e6 : 1e3) * tolerance;
  }

  void begin() {
    find_accelerations();
    IDASetErrFile(ida_.get(), silent_.get());
    IDAInit(ida_.get(), residual_of, 0, y_.get(), yp_.get());
    IDASVtolerances(ida_.get(), tolerance_, weights_.get());
    IDASetUserData(ida_.get(), &model_);
    IDASetId(ida_.get(), kinds_.get());
    IDASetSuppressAlg(ida_.get(), SUNTRUE);
    IDASetMaxNumSteps(ida_.get(), 10'000'000);
    IDASetStopTime(ida_.get(), until_);
    IDASetInitStep(ida_.get(), 0.05 * std::sqrt(tolerance_));
    IDASetLinearSolver(ida_.get(), linear_.get(), matrix_.get());
    IDASetJacFn(ida_.get(), jacobian_of);
  }

  /// The state at t by the method's own interpolation. Throws when it stops before.
  Motions advance(double t, bool wanted) {
    double reached = 0;
    const int code = IDASolve(ida_.get(), t, &reached, y_.get(), yp_.get(), IDA_NORMAL);
    if (code < 0)
      throw std::runtime_error("IDA stopped at t = " + std::to_string(reached) + " with code " + std::to_string(code));
    return wanted ? model_.motions(data(y_.get())) : Motions{};
  }
  Motions start() const { return model_.motions(data(y_.get())); }

  long n_steps() const { return count(IDAGetNumSteps); }
  std::string note() const {
    return "residuals=" + std::to_string(count(IDAGetNumResEvals)) +
           " jacobians=" + std::to_string(count(IDAGetNumJacEvals)) + " band=" + std::to_string(model_.band());
  }

 private:
  using Vector = std::unique_ptr<std::remove_pointer_t<N_Vector>, std::function<void(N_Vector)>>;
  using Context = std::unique_ptr<std::remove_pointer_t<SUNContext>, std::function<void(SUNContext)>>;

  static Context make_context() {
    SUNContext context = nullptr;
    SUNContext_Create(nullptr, &context);
    return owned(context, [](SUNContext c) { SUNContext_Free(&c); });
  }
  Vector vector() const { return owned(N_VNew_Serial(model_.size(), context_.get()), N_VDestroy); }

  long count(int (*get)(void*, long*)) const {
    long n = 0;
    get(ida_.get(), &n);
    return n;
  }

  // IDA's own start is for index 1 only.
  void find_accelerations() {
    const Vector right = vector(), solution = vector();
    SUNMatZero(matrix_.get());
    model_.acceleration_system(data(y_.get()), data(right.get()),
                               [&](int i, int j, double x) { SM_ELEMENT_B(matrix_.get(), i, j) += x; });
    SUNLinSolSetup(linear_.get(), matrix_.get());
    SUNLinSolSolve(linear_.get(), matrix_.get(), solution.get(), right.get(), 0);
    const double* x = data(solution.get());
    for (int i = 0; i < model_.size(); ++i)
      if (model_.is_differential(i)) data(yp_.get())[i] = x[i];
    for (const Pin& pin : model_.pins())
      for (int i = 0; i < 2; ++i) data(y_.get())[pin.at + i] = x[pin.at + i];
  }

  Model model_;
  Context context_;
  Vector y_, yp_, kinds_, weights_;
  std::unique_ptr<std::remove_pointer_t<SUNMatrix>, std::function<void(SUNMatrix)>> matrix_;
  std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, std::function<void(SUNLinearSolver)>> linear_;
  std::unique_ptr<char, std::function<void(char*)>> ida_;
  std::unique_ptr<FILE, std::function<void(FILE*)>> silent_;
  double tolerance_, until_;
};

void simulate(Run& run, double tolerance) {
  Solver solver(run.mechanism, tolerance);
  if (run.sampled) run.sample(0, solver.start());
  run.start_clock();
  solver.begin();
  for (int i = 1; i <= kReports; ++i) {
    const double t = run.mechanism.until * i / kReports;
    const Motions now = solver.advance(t, run.sampled);
    if (run.sampled) run.sample(t, now);
    run.check_time();
  }
  run.stop_clock();
  run.steps = solver.n_steps();
  run.note = solver.note();
}

}  // namespace

int main(int argc, char** argv) {
  Bench bench("ida", argc, argv);
  for (const Mechanism& m : all_mechanisms())
    if (m.kind == Kind::chain || m.kind == Kind::four_bars)
      bench.sweep(
          m, "BDF-banded", tolerance_ladder(),
          [](double tolerance) { return [=](Run& run) { simulate(run, tolerance); }; }, 0.25);
}
