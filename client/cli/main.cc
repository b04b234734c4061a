#include "client/cli/program.h"
#include "core/base/allocation.h"

int main(int argc, char** argv) {
  meshfront::ReturnLargeArraysToTheSystem();
  return meshfront::RunProgram(argc, argv);
}
