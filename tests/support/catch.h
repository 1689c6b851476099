// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file Catch2 in the version that is installed, 3 or 2.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
#endif
