// SPDX-License-Identifier: BSD-3-Clause
// The inputs of the mechanism that is being built: numbers that a host sets, for the law 'input'.
#pragma once

#include <functional>
#include <string>

#include <lockstep/detail/export.h>

namespace lockstep {

/// While it exists, laws made in this thread find inputs by it. Scopes nest.
class LOCKSTEP_API InputScope {
 public:
  using Reader = std::function<double()>;  ///< the present value of an input
  /// `find`: the input of a name, which is added with this value if there is none.
  using Find = std::function<Reader(const std::string& name, double value)>;
  explicit InputScope(Find find);
  ~InputScope();
  InputScope(const InputScope&) = delete;
  InputScope& operator=(const InputScope&) = delete;

  /// By the innermost scope of this thread; a law that is made outside of any keeps the value.
  static Reader find(const std::string& name, double value);

 private:
  Find find_;
  const InputScope* outer_;
};

}  // namespace lockstep
