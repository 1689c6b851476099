// FewMessages: what many runs say of themselves, once or not at all.
#pragma once

#include <memory>

#include <lockstep/log.h>

namespace lockstep {

/// While it exists, only the first `most` messages reach the logger, and a last one that says so.
class FewMessages {
 public:
  explicit FewMessages(long most);
  ~FewMessages();
  FewMessages(const FewMessages&) = delete;
  FewMessages& operator=(const FewMessages&) = delete;

 private:
  std::shared_ptr<spdlog::logger> usual_;
};

}  // namespace lockstep
