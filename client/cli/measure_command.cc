#include "client/cli/commands.h"
namespace meshfront {
ExitCode RunMeasure(const MeasureArguments&) { return ExitCode::kInternalError; }
}  // namespace meshfront
