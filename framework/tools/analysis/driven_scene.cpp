// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/driven_scene.h"

#include <algorithm>
#include <cmath>

#include <lockstep/author/lock.h>
#include <lockstep/text.h>
#include "framework/description/scene/system_of.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/expression/expression.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {
namespace {

constexpr int kDefaultPoses = 100;  // if the scene has no interval of outputs

// Words of quantities that depend on masses.
constexpr const char* kOfMasses[] = {"force", "torque",   "lambda", "energy", "power",
                                     "work",  "momentum", "center", "mass",   "loss"};

// Keys of bodies that give a mass, or need none.
constexpr const char* kGiveMass[] = {"mass", "rod", "box", "cylinder", "sphere", "compound", "particle", "fixed"};

/// A channel without its owner: "force_on_p_world_x" of "A.force_on_p_world_x"; the whole if it has none.
std::string quantity_of(const std::string& channel, const System& system) {
  const std::string owner = channels::owner_of(channel, system).second;
  return owner.empty() ? channel : channel.substr(owner.size() + 1, channel.find('@', owner.size()) - owner.size() - 1);
}

/// The motion between two poses, by one that goes its own way: the poses of the table do not depend on it.
class BetweenPoses final : public InsideStep {
 public:
  BetweenPoses(const DrivenMotion& from, Dynamics& dynamics, const Sample& end)
      : begin_(from.state().t), motion_(from), dynamics_(dynamics), end_(end) {}
  double begin() const override { return begin_; }
  const Sample& end() const override { return end_; }
  bool has_states() const override { return true; }
  Sample at(double t) const override {
    motion_.to(t), end_.forget();
    return {dynamics_, motion_.state(), end_.report};
  }
  bool along_laws() const override { return true; }

 private:
  const double begin_;
  mutable DrivenMotion motion_;
  Dynamics& dynamics_;
  const Sample& end_;
};

// What the scene asks for: visit(request, where it stands).
template <class Visit>
void each_request(const Mechanism& m, const Visit& visit) {
  for (const ChannelRequest& r : m.run.record) visit(r, "run.record");
  for (const ChannelRequest& r : m.run.require) visit(r, "scene.require");
}

void refuse_columns_of_masses(const Mechanism& m, const std::vector<std::string>& without) {
  each_request(m, [&](const ChannelRequest& request, const char* owner) {
    for (const std::string& channel : expression::channels_in(request.channel))
      if (std::ranges::any_of(kOfMasses, [quantity = quantity_of(channel, m.system)](const char* word) {
            return quantity.find(word) != std::string::npos;
          }))
        refuse(request.where, owner,
               "\"" + request.channel + "\" depends on masses, and " + text::join(without) +
                   (without.size() == 1 ? " has none" : " have none") + "; add them, or leave out the column");
  });
}

void refuse_integrated_columns(Mechanism& m) {
  each_request(m, [&](const ChannelRequest& request, const char* owner) {
    const std::size_t before = m.system.auxiliaries().size();
    make_channel(system_of(m), request.channel);
    for (std::size_t k = before; k < m.system.auxiliaries().size(); ++k)
      refuse(request.where, owner,
             "\"" + request.channel + "\" needs '" + m.system.auxiliaries()[k]->name() +
                 "', which is integrated over time; use lockstep run, or leave out the column");
  });
}

void record_reactions(Mechanism& m) {
  const auto add = [&](const std::string& channel) {
    if (std::ranges::none_of(m.run.record, [&](const ChannelRequest& r) { return r.column() == channel; }))
      m.run.record.push_back({channel, "", {}});
  };
  for (const auto& link : m.system.links()) {
    const Driven* driven = link->driven();
    if (link->pairs().empty()) continue;
    for (int d = 0; driven != nullptr && d < driven->n_drives(); ++d) {
      const std::string axis = driven->drive(d).name;
      add(link->name() + ".drive_" + axis +
          (axis.starts_with('r') ? ".torque_on_p_link_" + axis.substr(1) : ".force_on_p_link_" + axis));
      add(link->name() + ".drive_" + axis + ".power");
    }
  }
  for (const auto& link : m.system.links()) {
    if (link->pairs().empty() || m.system.merged(*link)) continue;
    for (const char* what : {".force_on_p_world_", ".torque_on_p_world_"})
      for (const char* axis : {"x", "y", "z"}) add(link->name() + what + axis);
  }
}

}  // namespace

std::vector<std::string> fill_masses(Scene& scene) {
  std::vector<std::string> names;
  const auto fill = [&](Value& root) {
    names.clear();
    for (Value& body : items(root, "bodies")) {
      if (body.object() == nullptr) continue;
      if (std::ranges::any_of(kGiveMass, [&](const char* kind) { return body.find(kind) != nullptr; })) continue;
      body.object()->push_back({"mass", Value(1.0), body.where});
      if (body.find("inertia") == nullptr)
        body.object()->push_back({"inertia", Value(Value::List{1.0, 1.0, 1.0}), body.where});
      if (const std::string* name = text_under(body, "name")) names.push_back(*name);
    }
  };
  if (scene.root.object() != nullptr) change_root(scene, fill);
  return names;
}

void record_driven(Mechanism& m, const std::vector<std::string>& without, bool inverse) {
  record_places(m);
  if (!without.empty()) refuse_columns_of_masses(m, without);
  if (inverse) record_reactions(m);
  refuse_integrated_columns(m);
}

std::vector<double> pose_times(const RunSettings& run) {
  const double until = run.until, interval = run.output > 0 ? run.output : until / kDefaultPoses;
  std::vector<double> times = run.times;
  if (!times.empty()) return times;
  const double whole = std::floor(until / interval * (1 + 1e-12));
  for (double k = 0; k <= whole; ++k) times.push_back(std::min(k * interval, until));
  if (times.back() < until * (1 - 1e-12)) times.push_back(until);
  return times;
}

void follow(DrivenMotion& motion, Dynamics& dynamics, const std::vector<double>& times,
            const std::vector<Observer*>& observers, const std::function<void(const Sample&)>& seen,
            const std::function<std::string()>& lines) {
  const StepReport none;
  try {
    for (const double& t : times) {
      const DrivenMotion before = motion;
      motion.to(t);
      const Sample sample(dynamics, motion.state(), none);
      for (Observer* each : observers)
        if (&t == &times.front())
          each->start(sample);
        else
          each->inside(BetweenPoses(before, dynamics, sample)), each->step(sample);
      seen(sample);
    }
  } catch (const Error& error) {
    rethrow_with(cause_of_stop(dynamics, motion.state()), error, lines());
  }
}

}  // namespace lockstep
