#include <signal.h>
#include <unistd.h>

#include <cstring>

#include "client/cli/exit_code.h"
#include "client/cli/program.h"
#include "core/base/allocation.h"

namespace {

// Libraries abort when they find no memory for a few bytes: to a script that is an internal error, as any other.
void OnAbort(int) {
  constexpr char message[] = "meshfront: internal error; there may not be enough memory for this job\n";
  if (write(STDERR_FILENO, message, std::strlen(message)) < 0) {
  }
  _exit(static_cast<int>(meshfront::ExitCode::kInternalError));
}

}  // namespace

int main(int argc, char** argv) {
  const bool serves = argc > 1 && std::strcmp(argv[1], "serve") == 0;
  serves ? meshfront::ReturnLargeArraysToTheSystem() : meshfront::ReuseLargeArrays();
  meshfront::ShareHeapsBetweenThreads();
  meshfront::KeepReserveForErrors();
  signal(SIGABRT, OnAbort);
  return meshfront::RunProgram(argc, argv);
}
