// The server's command line, shared by `meshfrontd` and `meshfront serve`.
#pragma once

namespace meshfront {

// Parses the flags (argv[0] is the name for messages), serves until SIGTERM or SIGINT, drains, and returns the exit
// code: 0 done, 2 usage, 5 the address can't be had, 70 internal error. The process ends at once with 1 on a second signal, and
// when calls are open longer than the drain timeout. Call it before any thread is started: it takes over both signals.
int ServeMain(int argc, char** argv);

}  // namespace meshfront
