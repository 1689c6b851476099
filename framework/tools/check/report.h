// What a check found: a value. Each finding says in words what is wrong and where to look.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/foundation/support/export.h"

namespace lockstep {

/// Where the checks look. States are drawn about the start of the system; equal seeds draw equal states.
struct CheckOptions {
  std::uint64_t seed = 1;
  int states = 8;           ///< random states (laws: 8 instants for each)
  double from = 0, to = 2;  ///< the time that is looked at, s
  double reach = 0.3;       ///< moves of bodies from their places at the start, of the distance between them
  double turn = 0.5;        ///< turns from there, rad
  int pairs = 1;            ///< marker pairs of a type that is made from a registry
};

struct Finding {
  std::string what;  ///< the entry, what it is, and what it should be
  std::string look;  ///< where to look
};

/// The findings of one check, worst entry of each kind only.
class LOCKSTEP_API CheckReport {
 public:
  /// `subject`: "link 'cam' (cam_follower)".
  CheckReport(std::string subject, std::uint64_t seed) : subject_(std::move(subject)), seed_(seed) {}

  bool ok() const { return findings_.empty(); }
  /// The subject and "nothing found" or the findings, one a line; then how good the differences were and the notes.
  std::string text() const;

  const std::string& subject() const { return subject_; }
  std::uint64_t seed() const { return seed_; }
  const std::vector<Finding>& findings() const { return findings_; }
  const std::vector<std::string>& notes() const { return notes_; }  ///< no faults: what was measured, what was left out
  long comparisons() const { return n_comparisons_; }
  double accuracy() const { return accuracy_; }  ///< worst error of a difference, of the size of what was compared

  // -- for those who check
  /// Takes a finding; of those with one key (kind and entry) the one with the largest `weight` stays.
  void add(const std::string& key, Finding, double weight = 0);
  void note(std::string words);
  /// A comparison was made; its differences were good to `error` of the size.
  void compared(double error);
  /// All findings and notes of another report.
  void take(const CheckReport&);

 private:
  struct Key {
    std::string key;
    double weight;
  };
  std::string subject_;
  std::uint64_t seed_;
  std::vector<Finding> findings_;
  std::vector<Key> keys_;
  std::vector<std::string> notes_;
  long n_comparisons_ = 0;
  double accuracy_ = 0;
};

/// "; it has the wrong sign", "; it is half of that: ...": what a wrong number looks like beside the right one; "" when
/// nothing comes to mind.
LOCKSTEP_API std::string likeness(double is, double should_be);

}  // namespace lockstep
