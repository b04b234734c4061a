// The server's command line, shared by `meshfrontd` and `meshfront serve`.
#pragma once

namespace meshfront {

// Parses the flags (argv[0] is the name for messages), serves until SIGTERM or SIGINT, drains, and returns the exit
// code: 0 done, 2 usage, 5 the address can't be had. A second signal ends the process at once with 1. Call it before
// any thread is started: it takes over both signals.
int ServeMain(int argc, char** argv);

}  // namespace meshfront
