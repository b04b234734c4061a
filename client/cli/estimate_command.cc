#include <iostream>

#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "client/cli/call_failure.h"
#include "client/cli/commands.h"
#include "client/cli/connection.h"
#include "client/cli/feature_lines.h"
#include "client/cli/input.h"
#include "client/cli/process.h"
#include "client/cli/stats.h"
#include "client/cli/text.h"
#include "core/base/status_macros.h"

namespace meshfront {
namespace {

struct EstimateCall {
  CallOptions call;
  double timeout = 0;
  Format format = Format::kUnknown;
  FeatureLines features;
};

absl::StatusOr<EstimateCall> Parse(const EstimateArguments& arguments) {
  EstimateCall parsed;
  MESHFRONT_ASSIGN_OR_RETURN(parsed.call.options, ParseMeshingFlags(arguments.meshing));
  MESHFRONT_ASSIGN_OR_RETURN(parsed.call.region_faces, ReadRegionFaces(arguments.meshing.region));
  MESHFRONT_ASSIGN_OR_RETURN(parsed.features, ReadFeatureLines(arguments.meshing.features));
  parsed.call.features = parsed.features.lines;
  MESHFRONT_ASSIGN_OR_RETURN(parsed.timeout, ParseTimeout(arguments.call.timeout));
  if (!arguments.call.server.empty()) MESHFRONT_RETURN_IF_ERROR(CheckServerAddress(arguments.call.server));
  MESHFRONT_ASSIGN_OR_RETURN(parsed.format, FormatFor(arguments.in, arguments.call.in_format, "--in-format"));
  return parsed;
}

void Print(const v1::EstimateResponse& e) {
  const v1::Topology& t = e.input().topology();
  std::cout << absl::StrFormat("input       %s vertices, %s triangles\n", WithThousands(t.vertices()),
                               WithThousands(t.triangles()))
            << absl::StrFormat("predicted   %s triangles\n", WithThousands(e.predicted_triangles()))
            << absl::StrFormat("edges       %g to %g, median %g\n", e.edge_length().min(), e.edge_length().max(),
                               e.edge_length().median())
            << absl::StrFormat("error       at most %g (%.3g%% of the diagonal)\n", e.error_bound(),
                               e.input().diagonal() > 0 ? 100 * e.error_bound() / e.input().diagonal() : 0)
            << absl::StrFormat("memory      about %s\n", WithByteUnit(e.memory_bytes()));
}

}  // namespace

ExitCode RunEstimate(const EstimateArguments& arguments) {
  absl::StatusOr<EstimateCall> parsed = Parse(arguments);
  if (!parsed.ok()) return Fail(ExitCode::kUsage, parsed.status());
  Interruption interruption;
  absl::StatusOr<ReadResult> read = ReadInput(arguments.in, parsed->format);
  if (!read.ok()) return Fail(ExitCodeOfRead(read.status()), read.status());

  CallCanceller canceller;
  parsed->call.canceller = &canceller;
  interruption.OnSignal([&canceller] { canceller.Cancel(); });
  const absl::StatusOr<std::unique_ptr<Connection>> connection =
      Connect(arguments.call.server, parsed->call.options.threads());
  if (!connection.ok()) return Fail(ExitCode::kInternalError, connection.status());
  if (arguments.call.timeout) parsed->call.deadline = absl::Now() + absl::Seconds(parsed->timeout);
  const absl::StatusOr<v1::EstimateResponse> estimate =
      (*connection)->client().Estimate(std::move(read->mesh), parsed->call);
  interruption.OnSignal([] {});
  if (!estimate.ok()) {
    const absl::Status told =
        WithFeatureLine(estimate.status(), arguments.meshing.features.value_or(""), parsed->features);
    return FailCall(told, {arguments.in, arguments.call.server, parsed->timeout});
  }
  PrintWarnings(read->warnings);
  if (arguments.json)
    std::cout << EstimateJson(*estimate).dump(2) << "\n";
  else
    Print(*estimate);
  return std::cout.flush() ? ExitCode::kDone
                           : Fail(ExitCode::kOutput, absl::InternalError("standard output can't be written"));
}

}  // namespace meshfront
