// SPDX-License-Identifier: BSD-3-Clause
// Builder: builds a mechanism from a scene. Private to this room.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/description/scene/system_of.h"
#include "framework/description/scene/tables.h"
#include "framework/mechanism/params/input_scope.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/refusals.h"

namespace lockstep {

class JointTree;

/// "joint 'A'": kind and name as in messages.
LOCKSTEP_API std::string owner_of(const std::string& kind, const std::string& name);
/// The same for an object of a list, whose name may be missing or not a text: then "links[2]".
std::string owner_of(const std::string& kind, const Value& object, const std::string& list, std::size_t index);

/// An object of a table without a shelf, checked, its laws made. The object outlives them.
Params params_of(const Value& object, const std::string& table, const std::string& owner, const Registry* laws);
Params params_of(Value&&, const std::string&, const std::string&, const Registry*) = delete;

/// The object of a table under a key of another one.
Params params_under(const Params& parent, const std::string& key, const std::string& table);

/// The items of a list under a key; none when it is absent. Throws when it holds no list: `expected`, for the message.
const Value::List& items_of(const Params& parent, const std::string& key,
                            const std::string& expected = "a list of objects");

/// Calls read(object, owner) for each of them.
template <class F>
void for_each_object(const Params& parent, const std::string& key, F&& read) {
  for (std::size_t i = 0; const Value& each : items_of(parent, key))
    read(each, item(part_of(parent.owner(), key), i++));
}

/// The list of texts under a key; none when it is absent.
std::vector<std::pair<std::string, SourceLocation>> texts_of(const Params& parent, const std::string& key);

/// A number that must be greater than zero.
double positive(const Params&, const std::string& key, const std::string& what);

/// Runs f; a ModelError becomes a SceneError at `where`.
template <class F>
decltype(auto) placed(const SourceLocation& where, F&& f) {
  return placed(where, "", std::forward<F>(f));
}

/// The value within this one, or the one of a key within it, at the place of an error; null: there is none.
const Value* refused_value(const Value&, const ErrorData&);

/// The errors of a scene's things. All of them are tried. Of a thing that names a failed one, only errors of its own
/// values are kept, since the others may follow from that failure.
class LOCKSTEP_API SceneErrors {
 public:
  /// Runs the reader of the value and keeps its errors, except those that may follow from a failure of another thing that
  /// the value names. Returns whether there were none.
  template <class F>
  bool attempt(const Value& read, F&& act) {
    try {
      std::forward<F>(act)();
      return true;
    } catch (const SceneError& error) {
      note(read, &error);
    } catch (const ModelError&) {  // of a System that lacks what failed
      if (refusals_.empty()) throw;
      note(read, nullptr);
    }
    return false;
  }
  /// The same, for errors at a value within the one that is read.
  template <class F>
  void within(const Value& read, F&& act) {
    try {
      std::forward<F>(act)();
    } catch (const SceneError& error) {
      if (refused_value(read, error) != nullptr) note(read, &error);
    } catch (const Error&) {
    }
  }
  /// A body of this name replaces one that failed: things that name it are built, and may not fit it.
  void stand_in(const std::string& name) { stand_ins_.insert(name); }
  /// A thing has a wrong name: unknown names that are near no other may mean it, and are not reported.
  void misname() { misnamed_ = true; }
  bool empty() const { return refusals_.empty(); }
  bool full() const { return refusals_.full(); }
  /// Throws one SceneError of all, a line each, if there are any.
  void raise() const { refusals_.raise(); }

 private:
  using Names = std::set<std::string, std::less<>>;
  void note(const Value& read, const SceneError* error);
  bool is_own(const Value& read, const SceneError&) const;

  Refusals refusals_;
  Names failed_, stand_ins_;
  bool misnamed_ = false;
};

/// Called with the things that were built although others failed; adds further errors.
using AlsoWrong = std::function<void(Mechanism&, SceneErrors&)>;

/// build_mechanism() of scene.h, which lets the caller add errors if there are any.
LOCKSTEP_API Mechanism build_mechanism(const Scene&, const Registry&, const AlsoWrong&);

class Builder {
 public:
  Builder(const Scene& scene, const Registry& registry, Mechanism& out, const AlsoWrong& also)
      : scene_(scene), registry_(registry), out_(out), system_(system_of(out)), also_(also) {}
  void build();

 private:
  /// Builds the things of a list; `failed` is called for those with errors.
  using Act = void (Builder::*)(const Value& object, const std::string& owner);
  void all(const Params& root, const std::string& list, const std::string& kind, Act make, Act failed);
  void body(const Value& object, const std::string& owner);
  void stand_in(const Value& object, const std::string& owner);
  void matter(const Value& object, const Params& body, const std::string& name);
  void visual(const Params& body, const std::string& name);
  void marker(const Value& object, const std::string& owner);
  void check_side(const Value& word, const std::string& context) const;
  void note_sides(const Value& object, const std::string& owner);
  Marker* side(const Params& link, const std::string& key, const std::string& name, const Pose* other);
  Attachment attachment(const Params& common, const std::string& name, bool both);
  Attachment pairs(const Params& link, const std::string& name);
  void link(const Value& object, const std::string& owner);
  void drives(const Params& common, Lock& link);
  void laws(const Params& common, Lock& link);
  void unilateral(const Params& link, Lock&);
  void brought_along(const Params& link, const Attachment&, Lock&);
  void stops(const Value& object, const std::string& owner, const Attachment&);
  void start_speeds(const Params& common, const Lock& link);
  void force(const Value& object, const std::string& owner);
  void event(const Value& object, const std::string& owner);
  std::vector<std::string> switched_by(const Params& event, const std::string& key);
  void check_assembled() const;
  void define_numbers();
  InputScope::Reader input(const std::string& name, double value);
  void check_requirements() const;
  void set_merge(const std::string& how);
  void set_gravity(const Params& root);
  void doubt_centers() const;
  void set_up(const Params& root);
  void choose_plane(bool asked);
  std::shared_ptr<const JointTree> tree() const;
  const VelocityTarget* start_out_of(Plane) const;

  // Takes the name of a new thing; one that is taken, empty or ambiguous in channels is noted, and another taken.
  std::string claim(const Value& name, const std::string& kind);
  void check_name(const std::string& name, const SourceLocation&, const std::string& kind) const;
  std::string unnamed();  // a name for what cannot have its own
  bool is_taken(const std::string& kind, const std::string& name) const;
  std::vector<std::string> names(std::initializer_list<std::string> kinds) const;  // for messages

  const Scene& scene_;
  const Registry& registry_;
  Mechanism& out_;
  System& system_;  // of out_
  const AlsoWrong& also_;
  using Names = std::map<std::string, std::pair<std::string, SourceLocation>>;  // with their kinds and places
  std::array<Names, 2> taken_;  // of bodies, markers, links and forces; of events, which may have the same
  int n_unnamed_ = 0;           // things with invalid names
  SceneErrors errors_;
};

}  // namespace lockstep
