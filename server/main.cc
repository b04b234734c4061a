#include "core/base/allocation.h"
#include "server/serve_main.h"

int main(int argc, char** argv) {
  meshfront::ReturnLargeArraysToTheSystem();
  meshfront::ShareHeapsBetweenThreads();
  meshfront::KeepReserveForErrors();
  return meshfront::ServeMain(argc, argv);
}
