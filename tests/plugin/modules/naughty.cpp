// SPDX-License-Identifier: BSD-3-Clause
// A law, a link, a force and an integrator that do what their key "does" says, as soon as they can.
#include <stdexcept>

#include <lockstep/author/integrator.h>
#include <lockstep/author/plugin.h>
#include <lockstep/author/relative.h>
#include <lockstep/dynamics.h>

namespace {

using namespace lockstep;

constexpr double kWhen = 0.05;  // s: well inside a run

void misbehave(const std::string& does) {
  if (does == "std") throw std::runtime_error("no more");
  if (does == "int") throw 7;
  if (does == "error") {
    try {
      throw std::runtime_error("the table is empty");
    } catch (...) {
      std::throw_with_nested(ModelError("the profile has no point"));
    }
  }
}

Key does_key() { return {"does", Form::text, Unit::none, "", "what it does wrong"}; }

TypeInfo info_of(const char* name) { return {name, "does what it must not", {does_key()}}; }

struct NaughtyLaw final : MotionLaw {
  std::string does;
  static TypeInfo info() { return info_of("naughty_law"); }
  static LawPtr<MotionLaw> make(const Params& p) {
    auto law = std::make_shared<NaughtyLaw>();
    law->does = p.text("does");
    if (law->does == "null maker") return nullptr;
    if (law->does == "maker throws") throw std::runtime_error("no making");
    if (law->does == "maker throws int") throw 3;
    if (law->does == "maker refuses") p.refuse("does", "is of no use; write another word");
    return law;
  }
  LawValue at(double t) const override {
    if (t < kWhen && does != "nan at once") return {};
    misbehave(does);
    return {does.rfind("nan", 0) == 0 ? std::nan("") : 0.0, 0, 0};
  }
  void breakpoints(double, double, std::vector<double>&) const override {
    if (does == "no times") throw std::runtime_error("no times");
  }
};

/// Holds P at S along the axes of S, and writes wrongly.
class NaughtyLink final : public Lock, public Stateful, public Remembering, public TangentFormula {
 public:
  NaughtyLink(const Attachment& attachment, std::string does)
      : Lock(attachment.name), p_(&attachment.p()), s_(&attachment.s()), does_(std::move(does)) {}
  static TypeInfo info() { return info_of("naughty_link"); }
  static std::unique_ptr<Lock> make(const Attachment& attachment, const Params& p) {
    return std::make_unique<NaughtyLink>(attachment, p.text("does"));
  }
  std::string_view type() const override { return "naughty_link"; }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {{p_, s_}}; }
  RowPlan plan_rows() override {
    if (does_ == "setup") throw ModelError("its rod has no length");
    if (does_ == "setup int") throw 5;
    P_ = MarkerFrame(*p_), S_ = MarkerFrame(*s_);
    RowPlan plan;
    for (const char* name : {"x", "y", "z"}) plan.add({RowKind::translation, name});
    plan.slots.add(P_.slot);
    plan.slots.add(S_.slot);
    if (does_ == "bad slot") plan.slots.slot[0] = 77;
    return plan;
  }
  void gather(Group links, const Inputs& in, RowSpan out) const override {
    for (std::size_t i = 0; i < links.size(); ++i)
      static_cast<const NaughtyLink&>(*links[i]).fill(in, out.lane(does_ == "first lane" ? 0 : i));
  }
  const Stateful* stateful() const override { return this; }
  int n_states() const override { return does_ == "states" ? 1 : 0; }
  void start_states(std::span<double> s) const override {
    if (does_ == "states") s.data()[0] = s.data()[1] = 0;
  }
  void state_rates(const Inputs&, std::span<double> sd) const override { std::fill(sd.begin(), sd.end(), 0.0); }
  const Remembering* remembering() const override { return this; }
  int n_memory() const override { return does_ == "accept" ? 1 : 0; }
  void start_memory(std::span<double> z) const override { std::fill(z.begin(), z.end(), 0.0); }
  void accept_step(const Inputs& in, std::span<double>) const override {
    if (in.t > kWhen) throw std::runtime_error("cannot remember");
  }
  const TangentFormula* tangent_formula() const override { return does_ == "tangent" ? this : nullptr; }
  void tangent(const Inputs&, std::span<const double>, TangentSum&) const override {
    throw std::runtime_error("no tangent");
  }

 private:
  void fill(const Inputs& in, const RowBlock& block) const {
    if (in.t > kWhen) misbehave(does_);
    const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
    const Motion& O = in.slot(P_.slot);
    const int side1 = slots().position(P_.slot), side2 = slots().position(S_.slot);
    const Vec3 r = O.A * P_.u0;
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = Vec3::Unit(k);
      block.C(k) = P.x[k] - S.x[k];
      if (does_ == "nan" && in.t > kWhen) block.C(k) = std::nan("");
      if (does_ == "unwritten" && k == 2) continue;
      block.Ct(k) = 0;
      block.Qhat(k) = -(O.A * cross(O.w, cross(O.w, P_.u0)))[k];
      block.set(side1, k, e, Vec3(O.A.transpose() * cross(r, e)));
      if (side2 >= 0) block.set(side2, k, -e, Vec3::Zero());
    }
    if (does_ == "row") block.set(0, 40, Vec3::UnitX(), Vec3::Zero());
    if (does_ == "next row") block.C(3) = 1;
    if (does_ == "before") block.C(-3) = 1;
    if (does_ == "side") block.set(3, 0, Vec3::UnitX(), Vec3::Zero());
  }
  Marker *p_, *s_;
  std::string does_;
  MarkerFrame P_, S_;
};

class NaughtyForce final : public Force {
 public:
  NaughtyForce(const Attachment& attachment, std::string does)
      : Force(attachment.name), p_(&attachment.p()), does_(std::move(does)) {}
  static TypeInfo info() { return info_of("naughty_force"); }
  static std::unique_ptr<Force> make(const Attachment& attachment, const Params& p) {
    return std::make_unique<NaughtyForce>(attachment, p.text("does"));
  }
  std::string_view type() const override { return "naughty_force"; }
  std::vector<const Marker*> markers() const override { return {p_}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override {
    if (does_ == "slot") out.force(4, Vec3::UnitX(), Vec3::Zero());
    const Motion& O = in.slot(p_->body->slot);
    if (does_ == "half a potential" || does_ == "no potential") out.force(p_->body->slot, -20 * O.x, O.x);
    if (in.t < kWhen) return;
    misbehave(does_);
    if (does_ == "nan") out.force(p_->body->slot, Vec3::Constant(std::nan("")), Vec3::Zero());
  }
  double potential(const Inputs& in) const override {
    if (does_ == "half a potential") return 5 * in.slot(p_->body->slot).x.squaredNorm();
    return none_from("nan potential", in);
  }
  double dissipation(const Inputs& in) const override { return none_from("nan dissipation", in); }
  double supply(const Inputs& in) const override { return none_from("nan supply", in); }

 private:
  double none_from(const char* word, const Inputs& in) const {
    return does_ == word && in.t >= kWhen ? std::nan("") : 0.0;
  }
  Marker* p_;
  std::string does_;
};

class NaughtyIntegrator final : public Integrator {
 public:
  explicit NaughtyIntegrator(std::string does) : does_(std::move(does)) {}
  static TypeInfo info_type() { return info_of("naughty_integrator"); }
  static std::unique_ptr<Integrator> make(const Params& p) {
    return std::make_unique<NaughtyIntegrator>(p.text("does"));
  }
  IntegratorInfo info() const override { return {"naughty_integrator", 1, false, false, 1}; }
  void begin(Dynamics&, const State&) override {
    if (does_ == "begin") throw std::runtime_error("no beginning");
  }
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    if (state.t > kWhen) misbehave(does_);
    if (state.t > kWhen && does_ == "step") throw StepError("the step is too long", state.t);
    dynamics.rate(state, rate_);
    state.q += h * rate_.q, state.v += h * rate_.v, state.t += h;
    dynamics.normalize(state);
    StepReport report;
    report.h = h;
    return report;
  }

 private:
  std::string does_;
  StateRate rate_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) {
  registry.laws.add<NaughtyLaw>();
  registry.links.add<NaughtyLink>();
  registry.forces.add<NaughtyForce>();
  registry.integrators.add(NaughtyIntegrator::info_type(), &NaughtyIntegrator::make);
}
