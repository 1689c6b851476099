#include "framework/tools/program/few_messages.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <mutex>

namespace lockstep {
namespace {

class FirstOnes final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  FirstOnes(std::shared_ptr<spdlog::logger> to, long most) : to_(std::move(to)), left_(most) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (left_ <= 0) return;
    to_->log(message.level, std::string_view(message.payload.data(), message.payload.size()));
    if (--left_ == 0) to_->log(message.level, "further messages of runs are not printed");
  }
  void flush_() override { to_->flush(); }

  std::shared_ptr<spdlog::logger> to_;
  long left_;
};

}  // namespace

FewMessages::FewMessages(long most) : usual_(logger()) {
  set_logger(std::make_shared<spdlog::logger>(usual_->name(), std::make_shared<FirstOnes>(usual_, most)));
}
// Where no memory is left the usual logger is made anew when it is asked for.
FewMessages::~FewMessages() {
  try {
    set_logger(usual_);
  } catch (...) {
  }
}

}  // namespace lockstep
