// The program: reads the command line and runs a subcommand.
#pragma once

namespace meshfront {

// The exit code of `meshfront` called with these arguments.
int RunProgram(int argc, char** argv);

}  // namespace meshfront
