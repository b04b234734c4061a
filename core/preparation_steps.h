// What the preparations of meshes and of point sets share.
#pragma once

#include <chrono>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/preparation.h"

namespace meshfront {

class Stopwatch {
 public:
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// The power of two that brings a diagonal into the range in which its fourth power is a number; 1 where it is.
double ScaleFor(double diagonal);

// The clamps of the edge length in the surface's scale, as given or from the sizes of the parts. InvalidArgument when
// they contradict each other.
absl::Status SetClamps(const RemeshOptions& options, absl::Span<const double> component_diagonals, Preparation& p);

// The field at the parameter given, or at the one that makes the number of triangles wanted.
absl::Status MakeField(Preparation& p, const Context& context);

}  // namespace meshfront
