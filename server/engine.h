// What the server needs of core, as functions: a test gives its own.
#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/io/mesh_io.h"
#include "core/mesh/mesh_sink.h"
#include "core/remesh.h"

namespace meshfront {

// Thread-safe: called by all workers at a time.
struct Engine {
  std::function<absl::StatusOr<Report>(Problem, MeshSink&, const Context&)> remesh;
  std::function<absl::StatusOr<Estimate>(Problem, const Context&)> estimate;
  std::function<absl::Status(Problem, LevelSink&, const Context&)> remesh_levels;
};

// Remesh, EstimateRemesh and RemeshLevels of core.
Engine CoreEngine();

}  // namespace meshfront
