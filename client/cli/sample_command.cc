#include "client/cli/commands.h"
#include "client/cli/sample_mesh.h"
#include "core/io/mesh_io.h"

namespace meshfront {

ExitCode RunSample(const std::string& path) {
  const absl::StatusOr<Format> format = FormatFor(path, std::nullopt, "a file name");
  if (!format.ok()) return Fail(ExitCode::kUsage, format.status());
  if (*format == Format::kUnknown || *format == Format::kXyz) {
    return Fail(ExitCode::kUsage,
                absl::InvalidArgumentError("OUT is " + path + "; its ending must be off, obj, ply, stl, glb or gltf"));
  }
  const absl::Status written = WriteMeshFile(path, SampleMesh(), *format);
  return written.ok() ? ExitCode::kDone : Fail(ExitCode::kOutput, written);
}

}  // namespace meshfront
