// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/link_numbers.h"

#include "framework/tools/batch/packs.h"

namespace lockstep::lanes {

void put_frames(const MarkerLock& lock, int lane, Link& link, std::span<double> to) {
  const MarkerFrame P(lock.p()), S(lock.s());
  if (link.turn == Turn::parallel && !(P.parallel() && S.parallel())) link.turn = Turn::plain;
  put_numbers(to, link.frames + frames::uP, lane, P.u0), put_numbers(to, link.frames + frames::uS, lane, S.u0);
  put_numbers(to, link.frames + frames::qP, lane, P.q0.coefficients());
  put_numbers(to, link.frames + frames::qS, lane, S.q0.coefficients());
  put_matrix(to, link.frames + frames::AP, lane, P.A0), put_matrix(to, link.frames + frames::AS, lane, S.A0);
}

void put_laws(const MarkerLock& lock, int lane, const Link& link, const Inputs& in, std::span<double> to) {
  if (link.moved) {
    const ImposedTranslation D = lock.imposed_translation(in);
    put_numbers(to, link.law + law::p, lane, D.p), put_numbers(to, link.law + law::pd, lane, D.pd);
    put_numbers(to, link.law + law::pdd, lane, D.pdd);
  }
  if (link.turn != Turn::law) return;
  const ImposedRotation D = lock.imposed_rotation(in);
  put_numbers(to, link.law + law::q, lane, D.q.coefficients()), put_matrix(to, link.law + law::A, lane, D.A);
  put_numbers(to, link.law + law::w, lane, D.w), put_numbers(to, link.law + law::a, lane, D.a);
}

}  // namespace lockstep::lanes
