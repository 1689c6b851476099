// The program `lockstep`.
#include "framework/runner/commands.h"

int main(int argc, char* argv[]) { return lockstep::run_program(argc, argv); }
