// Marks what the shared library shows to programs and plugins; everything else stays hidden.
#pragma once

#if defined(__GNUC__)
#define LOCKSTEP_API __attribute__((visibility("default")))
#else
#define LOCKSTEP_API
#endif
