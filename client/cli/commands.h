// The subcommands of the program, one function each: arguments in, exit code out. Messages go to standard error, results to
// standard output.
#pragma once

#include <string>

#include "client/cli/arguments.h"
#include "client/cli/exit_code.h"

namespace meshfront {

ExitCode RunRemesh(const RemeshArguments& arguments);
ExitCode RunEstimate(const EstimateArguments& arguments);
ExitCode RunMeasure(const MeasureArguments& arguments);
ExitCode RunRender(const RenderArguments& arguments);
ExitCode RunInfo(const std::string& path, const CallFlags& flags);
ExitCode RunSample(const std::string& path);
ExitCode RunFigures(const std::string& path);

}  // namespace meshfront
