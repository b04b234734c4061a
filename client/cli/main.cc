#include "client/cli/program.h"

int main(int argc, char** argv) { return meshfront::RunProgram(argc, argv); }
