// Meshes and point sets in files: the public door of this room.
//
// Reading trusts nothing: counts in headers are checked against the bytes that are there before anything is allocated, every
// index is checked, and memory stays below 20 times the (decompressed) file. What can't be trusted is refused with
// InvalidArgument and one sentence that says what and where ("bunny.off: line 7: …").
//
//   MESHFRONT_ASSIGN_OR_RETURN(ReadResult read, ReadMeshFile("bunny.off"));
//   for (const std::string& warning : read.warnings) std::cerr << warning << "\n";
//   MESHFRONT_RETURN_IF_ERROR(WriteMeshFile("bunny.glb", read.mesh));
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// The rows of the table in format_table.h.
enum class Format { kUnknown, kOff, kObj, kPly, kStl, kGlb, kGltf, kXyz };

// The format an ending stands for: "a/b.PLY.gz", ".ply" and "ply" are all kPly. Only the last ending counts, after ".gz" is
// taken off; case does not matter. kUnknown when no format claims it.
Format FormatOfName(std::string_view name_or_extension);
// "OFF", "PLY", … for messages; "unknown" for kUnknown.
std::string_view FormatName(Format format);

struct ReadLimits {
  uint64_t max_decompressed_bytes = 4ull << 30;  // of a file after gzip, and of all buffers a glTF file names together
  // Asked before the memory of a decompressed file grows to `bytes`: an error ends the reading and is returned. May be empty.
  std::function<absl::Status(uint64_t bytes)> admit;
};

struct GltfAsset;

// What a file holds beside its mesh, to be written again with another mesh of the same groups.
struct MeshAsset {
  std::vector<std::string> group_names;         // of materials; "" where one has none
  std::vector<std::string> material_libraries;  // of an OBJ
  std::shared_ptr<const GltfAsset> gltf;  // of a glTF: nodes, materials, textures, animations, skins (gltf_asset.h)
};

struct ReadResult {
  TriangleMesh mesh;                 // at least one vertex; every index in range; coordinates may be infinite or NaN
  Format format = Format::kUnknown;  // what the content turned out to be
  // One sentence each: a wrong ending, a count that lies, coordinates that are not finite, faces of fewer than three corners.
  // Attributes that were left behind are listed in mesh.dropped_attributes.
  std::vector<std::string> warnings;
  MeshAsset asset;
};

// Reads one mesh, gzip-compressed or not. The ending proposes a format, the content decides (with a warning when they differ).
// Polygons are cut into triangles: convex ones into a fan, others by ear clipping. Corners of STL files are welded where their
// coordinates are equal (0 and -0 are), nothing else is welded. Normals are kept for point sets only; they are scaled to unit
// length, and one that is zero or not finite becomes zero (with a warning; when all are, there are none).
// NotFound when the file can't be opened; InvalidArgument for what it holds; Unavailable when reading breaks off.
absl::StatusOr<ReadResult> ReadMeshFile(const std::string& path, const ReadLimits& limits = {});

// The same for bytes in memory. `name_for_messages` starts every message. A glTF file may name buffers in files inside
// `base_folder` (symbolic links are followed and must stay inside); when that is empty, none are opened.
absl::StatusOr<ReadResult> ReadMesh(absl::Span<const uint8_t> bytes, Format format,
                                    const std::string& name_for_messages, const ReadLimits& limits = {},
                                    const std::string& base_folder = "");

// Writes a mesh (or, except in STL, a point set) to a temporary name in the same folder, syncs it, and renames it: at every
// moment there is the old file or the new one, and after a failure no trace. A name that ends in ".gz" is compressed; a
// symbolic link is followed; a pipe or device is written straight. The format comes from the ending when it is kUnknown.
// Coordinates survive exactly in OFF, OBJ, XYZ (shortest text that reads back to the same double) and PLY (doubles); STL, GLB
// and glTF hold 32 bits, the latter two relative to the centre when the mesh is far from the origin.
// InvalidArgument: no format, an empty mesh, an index out of range, a value the format can't hold. Otherwise what the system
// said: NotFound, PermissionDenied, ResourceExhausted (disk full), …
absl::Status WriteMeshFile(const std::string& path, const TriangleMesh& mesh, Format format = Format::kUnknown);

// The bytes WriteMeshFile would write.
absl::StatusOr<std::string> FormatMesh(const TriangleMesh& mesh, Format format);

// Whether files of the format hold attributes of triangle meshes: OBJ, PLY, GLB and glTF.
bool HoldsAttributes(Format format);
// A triangle mesh with its attributes and the asset around it. Attributes that the format has no place for are appended to `left_out`,
// as is what of the asset goes: a glTF can be written again as a glTF only. OBJ: vt, vn, usemtl; PLY: channels of which no
// vertex has two values, colours in 8 bits, normals, texture coordinates and other numbers in 32; glTF: float32, positions relative to their node.
// InvalidArgument and InternalError as FormatMesh.
absl::StatusOr<std::string> FormatAsset(const TriangleMesh& mesh, Format format, const MeshAsset& asset,
                                        std::vector<std::string>& left_out);

// One mesh of a chain of levels of detail.
struct DetailLevel {
  const TriangleMesh* mesh = nullptr;
  double coverage =
      0;  // MSFT_screencoverage: of the screen, from which on it is to be shown, falling from level to level
};
// The same for several meshes of one asset, the finest first, as one GLB or glTF: each node that has a mesh has the first, and names nodes
// with the others by the extension MSFT_lod. What hangs on or moves such a node is there at every level.
absl::StatusOr<std::string> FormatLevels(absl::Span<const DetailLevel> levels, Format format, const MeshAsset& asset,
                                         std::vector<std::string>& left_out);

// The files that an asset names and is not whole without, as it names them: images of a glTF that lie beside it, an OBJ's material
// libraries. They are named again, never copied.
std::vector<std::string> FilesBeside(const MeshAsset& asset);

}  // namespace meshfront
