#include "server/engine.h"

namespace meshfront {

Engine CoreEngine() {
  return {
      .remesh = [](Problem problem, MeshSink& sink,
                   const Context& context) { return Remesh(std::move(problem), sink, context); },
      .estimate = [](Problem problem, const Context& context) { return EstimateRemesh(std::move(problem), context); },
      .remesh_levels = [](Problem problem, LevelSink& sink,
                          const Context& context) { return RemeshLevels(std::move(problem), sink, context); }};
}

}  // namespace meshfront
