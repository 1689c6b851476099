#pragma once
/// @file LOCKSTEP_API marks what the shared library shows; everything else stays hidden.
/// Needed on functions defined in a .cpp that others call, on classes with such members, and on every class that is
/// thrown or has virtual functions and crosses the border to a program or a plugin (their type records must be one).

#if defined(_WIN32)
#if defined(lockstep_EXPORTS)
#define LOCKSTEP_API __declspec(dllexport)
#else
#define LOCKSTEP_API __declspec(dllimport)
#endif
#else
#define LOCKSTEP_API __attribute__((visibility("default")))
#endif
