// SPDX-License-Identifier: BSD-3-Clause
// What IDA works on: its memory, vectors, a dense matrix and its solver, made and freed together.
#pragma once

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <new>
#include <type_traits>

#include <lockstep/math.h>

namespace lockstep::ida_plugin {

static_assert(std::is_same_v<realtype, double>, "SUNDIALS was built for another precision");

using Flat = Eigen::Map<VecX>;

/// For n numbers; throws std::bad_alloc.
class Memory {
 public:
  explicit Memory(Eigen::Index n) {
    SUNContext_Create(nullptr, &context_);
    u = N_VNew_Serial(n, context_);
    ud = N_VNew_Serial(n, context_);
    inside = N_VNew_Serial(n, context_);
    J_ = SUNDenseMatrix(n, n, context_);
    solver_ = SUNLinSol_Dense(u, J_, context_);
    ida = IDACreate(context_);
    if (!u || !ud || !inside || !J_ || !solver_ || !ida) {
      release();
      throw std::bad_alloc();
    }
  }
  ~Memory() { release(); }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  /// From u and ud at t; `self` is what the callbacks get.
  void start(double t, IDAResFn residual, IDALsJacFn jacobian, IDAEwtFn weights, int max_order, void* self) {
    IDAInit(ida, residual, t, u, ud);
    IDASetUserData(ida, self);
    IDASetErrHandlerFn(
        ida, [](int, const char*, const char*, char*, void*) {}, nullptr);  // errors are reported by Ida
    IDAWFtolerances(ida, weights);
    IDASetLinearSolver(ida, solver_, J_);
    IDASetJacFn(ida, jacobian);
    IDASetMaxOrd(ida, max_order);
  }

  void* ida = nullptr;
  N_Vector u = nullptr, ud = nullptr, inside = nullptr;  // inside: u at an instant within the last step

 private:
  void release() {
    if (ida) IDAFree(&ida);
    if (solver_) SUNLinSolFree(solver_);
    if (J_) SUNMatDestroy(J_);
    for (N_Vector v : {inside, ud, u})
      if (v) N_VDestroy(v);
    SUNContext_Free(&context_);
  }

  SUNContext context_ = nullptr;
  SUNMatrix J_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
};

inline Flat numbers(N_Vector v) { return {N_VGetArrayPointer(v), N_VGetLength(v)}; }

}  // namespace lockstep::ida_plugin
