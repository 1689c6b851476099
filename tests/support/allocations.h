// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file Counts what a piece of code takes from the heap: new, malloc, and Eigen's own, wherever in the program.

/// Number of allocations that `act` makes.
long allocations();
template <class F>
long allocations_of(F&& act) {
  const long before = allocations();
  act();
  return allocations() - before;
}

/// Bytes of the heap that are in use, with what the C library adds to each block; by its own books.
double bytes_in_use();

/// False where a sanitizer owns the heap: then nothing is counted.
bool allocations_are_counted();
