#include "framework/mechanism/params/refusals.h"

#include <string_view>

namespace lockstep {
namespace {

constexpr int kMost = 20;  // lines

}  // namespace

bool Refusals::full() const { return n_ >= kMost; }

void Refusals::add(const SceneError& error) {
  if (n_ == 0) first_ = error;
  std::string_view rest = error.what();
  for (bool more = true; more && !full();) {
    const std::size_t end = rest.find('\n');
    lines_.append(n_++ == 0 ? "" : "\n").append(rest.substr(0, end));
    more = end != std::string_view::npos;
    if (more) rest.remove_prefix(end + 1);
  }
}

void Refusals::raise() const {
  if (n_ > 0) throw SceneError(lines_ + (full() ? "\nand perhaps more; these were the first" : ""), first_);
}

}  // namespace lockstep
