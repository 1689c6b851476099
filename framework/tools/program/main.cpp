// The program `lockstep`.
#include "framework/tools/program/commands.h"

int main(int argc, char* argv[]) { return lockstep::run_program(argc, argv); }
