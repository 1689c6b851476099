#pragma once
/// @file Counts the requests for memory of the whole process, Eigen's and the standard library's alike.

#include <cstddef>

namespace lockstep::test {

/// Calls of malloc, calloc, realloc, new and their aligned kin since the program began; differences are what counts.
std::size_t n_heap_requests();

}  // namespace lockstep::test
