#include "framework/version.h"

extern "C" LOCKSTEP_API const char* client_plugin_version() { return lockstep::library_version(); }
