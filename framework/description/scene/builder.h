// Builder: builds a mechanism from a scene. Private to this room.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/description/scene/system_of.h"
#include "framework/description/scene/tables.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/refusals.h"

namespace lockstep {

class JointTree;

/// "link 'A'": kind and name as in messages.
LOCKSTEP_API std::string owner_of(const std::string& kind, const std::string& name);
/// The same for an object of a list, whose name may be missing or not a text: then "links[2]".
std::string owner_of(const std::string& kind, const Value& object, const std::string& list, std::size_t index);

/// An object of a table without a shelf, checked, its laws made.
Params params_of(const Value& object, const std::string& table, const std::string& owner, const Registry* laws);

/// The objects under a key of Holds::objects; none when it is absent. Throws when it holds something else.
const Value::List& objects_of(const Params& parent, const std::string& key);

/// The texts under a key of Holds::texts.
std::vector<std::pair<std::string, Where>> texts_of(const Params& parent, const std::string& key);

/// A number that must be greater than zero.
double positive(const Params&, const std::string& key, const std::string& what);

/// Runs f; a ModelError becomes a SceneError at `where`, with `context` before its message.
template <class F>
decltype(auto) placed(const Where& where, const std::string& context, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (const ModelError& error) {
    refuse(where, context, error.what(), static_cast<const ErrorData&>(error));
  }
}
template <class F>
decltype(auto) placed(const Where& where, F&& f) {
  return placed(where, "", std::forward<F>(f));
}

/// What is wrong with the things of a scene. All of them are tried; of those that hang on one that failed nothing is
/// said, since that one may be all that is wrong.
class SceneErrors {
 public:
  /// Calls build(object, owner) for the objects of a list, each "bodies[2]" or "body 'a'".
  template <class Build>
  void for_each(const Params& root, const std::string& list, const std::string& kind, Build&& build) {
    attempt(root.value(list), [&] {
      const Value::List& items = objects_of(root, list);
      for (std::size_t i = 0; i < items.size() && !refusals_.full(); ++i)
        attempt(items[i], [&] { build(items[i], owner_of(kind, items[i], list, i)); });
    });
  }
  /// Runs what reads the value, and keeps what is refused, unless the value names what failed.
  template <class F>
  void attempt(const Value& read, F&& act) {
    try {
      std::forward<F>(act)();
    } catch (const SceneError& error) {
      note(read, &error);
    } catch (const ModelError&) {  // of a System that lacks what failed
      if (refusals_.empty()) throw;
      note(read, nullptr);
    }
  }
  /// Throws one SceneError of all, a line each, where there are any.
  void raise() const { refusals_.raise(); }

 private:
  void note(const Value& read, const SceneError* error);
  bool names_failed(const Value&) const;

  Refusals refusals_;
  std::set<std::string, std::less<>> failed_;  // names
};

class Builder {
 public:
  Builder(const Scene& scene, const Registry& registry, Mechanism& out)
      : scene_(scene), registry_(registry), out_(out), system_(system_of(out)) {}
  void build();

 private:
  void bodies(const Params& root);
  void body(const Value& object, const std::string& owner);
  void matter(const Value& object, const Params& body, const std::string& name);
  void visual(const Params& body, const std::string& name);
  void markers(const Params& root);
  void marker(const Value& object, const std::string& owner);
  Marker* side(const Params& link, const std::string& key, const std::string& name, const Pose* other);
  Attachment attachment(const Params& common, const std::string& name, bool both);
  Attachment pairs(const Params& link, const std::string& name);
  void links(const Params& root);
  void link(const Value& object, const std::string& owner);
  void drives(const Params& common, Lock& link);
  void laws(const Params& common, Lock& link);
  void unilateral(const Params& link, Lock&);
  void brought_along(const Params& link, const Attachment&, Lock&);
  void stops(const Value& object, const std::string& owner, const Attachment&);
  void start_speeds(const Params& common, const Lock& link);
  void forces(const Params& root);
  void force(const Value& object, const std::string& owner);
  std::pair<Marker*, Marker*> markers_of(const Params& force, const Lock& link, const Attachment& given);
  void events(const Params& root);
  void event(const Value& object, const std::string& owner);
  std::vector<std::string> switched_by(const Params& event, const std::string& key);
  void check_assembled() const;
  void set_merge(const std::string& how);
  void set_up(const Params& root);
  void choose_plane(bool asked);
  std::shared_ptr<const JointTree> tree() const;
  const VelocityTarget* start_out_of(Plane) const;

  // Notes the name of a new thing; refuses names that are taken, empty or ambiguous in channels.
  std::string claim(const Params& object, const std::string& kind);
  bool is_taken(const std::string& kind, const std::string& name) const;
  std::vector<std::string> names(const std::string& kind) const;  // all; for words of a refusal

  const Scene& scene_;
  const Registry& registry_;
  Mechanism& out_;
  System& system_;  // of out_
  std::map<std::string, std::map<std::string, Where>> taken_;  // kind -> name -> place
  SceneErrors errors_;
};

}  // namespace lockstep
