#include "tests/support/heap_counter.h"

#include <atomic>
#include <cerrno>

#if defined(__SANITIZE_ADDRESS__)
#define LOCKSTEP_WATCHED_BY_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LOCKSTEP_WATCHED_BY_SANITIZER 1
#endif
#endif

namespace {

std::atomic<std::size_t> n_requests{0};

}  // namespace

std::size_t lockstep::test::n_heap_requests() { return n_requests.load(std::memory_order_relaxed); }

#ifdef LOCKSTEP_WATCHED_BY_SANITIZER

// The sanitizer owns malloc, and tells.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, std::size_t),
                                                         void (*)(const volatile void*));
namespace {

const int installed = __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { ++n_requests; },
                                                                [](const volatile void*) {});

}  // namespace

#else

// The program's own definitions go before those of the C library, which keeps its work under these names.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) noexcept {
  n_requests.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  n_requests.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  n_requests.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  n_requests.fetch_add(1, std::memory_order_relaxed);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  n_requests.fetch_add(1, std::memory_order_relaxed);
  *out = __libc_memalign(alignment, size);
  return *out != nullptr ? 0 : ENOMEM;
}
}

#endif
