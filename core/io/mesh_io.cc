// 1. Bytes: the file in one buffer, inflated when it is gzip.
// 2. Format: the ending proposes, the content decides (ChooseFormat).
// 3. The row of the table reads.
// 4. FinishReading: what holds for every format: something is there, normals have unit length, odd coordinates are counted.
#include "core/io/mesh_io.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/io/file_bytes.h"
#include "core/io/format_table.h"
#include "core/io/gzip.h"
#include "core/io/source.h"
#include "core/io/text_scanner.h"

namespace meshfront {
namespace {

bool IsGzipName(std::string_view name) {
  return absl::EndsWithIgnoreCase(absl::string_view(name.data(), name.size()), ".gz");
}

// For text without a magic word and a name that says nothing: OBJ when a line begins like one, XYZ when the first is numbers.
Format GuessText(const Source& source) {
  TextScanner scanner(source.text().substr(0, 64 << 10));
  double number = 0;
  if (!scanner.SkipToContent()) return Format::kUnknown;
  if (scanner.ReadDouble(number)) return Format::kXyz;
  while (scanner.SkipToContent()) {
    if (scanner.Token() == "v") return Format::kObj;
    scanner.SkipLine();
  }
  return Format::kUnknown;
}

absl::StatusOr<Format> ChooseFormat(const Source& source, Format proposed, std::vector<std::string>& warnings) {
  const FormatRow* row = FindFormat(proposed);
  if (row != nullptr && row->is_surely != nullptr && row->is_surely(source)) return proposed;
  for (const FormatRow& other : FormatTable()) {
    if (other.is_surely == nullptr || !other.is_surely(source)) continue;
    if (row != nullptr) {
      warnings.push_back(
          Concat("the name says ", row->name, ", but the content is ", other.name, "; read as ", other.name));
    }
    return other.format;
  }
  if (row != nullptr) return proposed;
  const Format guess = GuessText(source);
  if (guess == Format::kUnknown)
    return Refuse(source, "neither the name nor the content says which mesh format this is");
  return guess;
}

// Normals to unit length; those without a direction to zero.
void FinishNormals(ReadResult& result) {
  std::vector<Vec3>& normals = result.mesh.normals;
  uint64_t lost = 0;
  for (Vec3& n : normals) {
    // Scaled first: the square of a length of 1e200 is no number.
    const double largest = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
    const bool usable = IsFinite(n) && largest > 0;
    n = usable ? Normalized(n / largest) : Vec3{};
    lost += !usable;
  }
  if (lost == 0) return;
  result.warnings.push_back(Concat(lost, " of ", normals.size(), " normals are zero or not finite",
                                   lost == normals.size() ? "; the normals were left out" : ""));
  if (lost == normals.size()) normals = {};
}

absl::Status FinishReading(const Source& source, ReadResult& result) {
  if (result.mesh.positions.empty()) return Refuse(source, "has no vertices; there is nothing to read");
  if (!result.mesh.triangles.empty()) result.mesh.normals = {};
  if (result.mesh.triangles.empty()) result.mesh.attributes = {};
  uint64_t odd = 0, first = 0;
  for (uint64_t i = 0; i < result.mesh.positions.size(); ++i) {
    if (!IsFinite(result.mesh.positions[i]) && odd++ == 0) first = i;
  }
  if (odd > 0) {
    result.warnings.push_back(Concat(odd, " of ", result.mesh.positions.size(),
                                     " vertices have a coordinate that is not finite, the first is vertex ", first));
  }
  FinishNormals(result);
  return absl::OkStatus();
}

absl::StatusOr<ReadResult> ReadSource(const Source& source, Format proposed) {
  if (source.bytes.empty()) return Refuse(source, "is empty (0 bytes)");
  std::vector<std::string> warnings;
  MESHFRONT_ASSIGN_OR_RETURN(const Format format, ChooseFormat(source, proposed, warnings));
  MESHFRONT_ASSIGN_OR_RETURN(ReadResult result, FindFormat(format)->read(source));
  result.format = format;
  result.warnings.insert(result.warnings.begin(), warnings.begin(), warnings.end());
  MESHFRONT_RETURN_IF_ERROR(FinishReading(source, result));
  return result;
}

absl::Status CheckWritable(const TriangleMesh& mesh) {
  if (mesh.positions.empty())
    return absl::InvalidArgumentError("the mesh has no vertices; an empty mesh is not written");
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()) {
    return absl::InvalidArgumentError(Concat("the mesh has ", mesh.normals.size(), " normals for ",
                                             mesh.positions.size(), " vertices; there must be one each, or none"));
  }
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const VertexId v : mesh.triangles[i]) {
      if (v.index() < mesh.positions.size()) continue;
      return absl::InvalidArgumentError(
          Concat("triangle ", i, " names vertex ", v.index(), "; there are ", mesh.positions.size()));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<const FormatRow*> FindWriter(Format format, const std::string& path) {
  const FormatRow* row = FindFormat(format == Format::kUnknown ? FormatOfName(path) : format);
  if (row != nullptr) return row;
  std::string endings;
  for (const FormatRow& r : FormatTable()) endings += Concat(endings.empty() ? "." : ", .", r.endings[0]);
  return absl::InvalidArgumentError(
      Concat(path.empty() ? "the format" : path, " names no format to write; it is one of ", endings));
}

absl::Status WriteTo(ByteSink& sink, const FormatRow& row, const TriangleMesh& mesh) {
  Output output(sink);
  MESHFRONT_RETURN_IF_ERROR(row.write(mesh, output));
  return output.Finish();
}

}  // namespace

Format FormatOfName(std::string_view name) {
  if (IsGzipName(name)) name.remove_suffix(3);
  const size_t dot = name.find_last_of("./");
  if (dot != std::string_view::npos) name = name[dot] == '.' ? name.substr(dot + 1) : "";
  for (const FormatRow& row : FormatTable()) {
    for (const std::string_view ending : row.endings) {
      if (absl::EqualsIgnoreCase(absl::string_view(name.data(), name.size()),
                                 absl::string_view(ending.data(), ending.size()))) {
        return row.format;
      }
    }
  }
  return Format::kUnknown;
}

std::string_view FormatName(Format format) {
  const FormatRow* row = FindFormat(format);
  return row != nullptr ? row->name : "unknown";
}

absl::StatusOr<ReadResult> ReadMesh(absl::Span<const uint8_t> bytes, Format format,
                                    const std::string& name_for_messages, const ReadLimits& limits,
                                    const std::string& base_folder) {
  Source source{bytes, name_for_messages, base_folder, limits};
  if (!IsGzip(bytes)) return ReadSource(source, format);
  MESHFRONT_ASSIGN_OR_RETURN(const ByteBuffer inflated, Inflate(source));
  source.bytes = inflated.span();
  return ReadSource(source, format);
}

absl::StatusOr<ReadResult> ReadMeshFile(const std::string& path, const ReadLimits& limits) {
  MESHFRONT_ASSIGN_OR_RETURN(ByteBuffer bytes, ReadWholeFile(path, limits.max_decompressed_bytes));
  const size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  Source source{bytes.span(), path, folder, limits};
  if (IsGzip(source.bytes)) {
    MESHFRONT_ASSIGN_OR_RETURN(ByteBuffer inflated, Inflate(source));
    bytes = std::move(inflated);
    source.bytes = bytes.span();
  }
  return ReadSource(source, FormatOfName(path));
}

absl::Status WriteMeshFile(const std::string& path, const TriangleMesh& mesh, Format format) {
  MESHFRONT_ASSIGN_OR_RETURN(const FormatRow* row, FindWriter(format, path));
  MESHFRONT_RETURN_IF_ERROR(CheckWritable(mesh));
  return ReplaceFile(path, [&](ByteSink& file) -> absl::Status {
    if (!IsGzipName(path)) return WriteTo(file, *row, mesh);
    GzipSink gzip(file);
    MESHFRONT_RETURN_IF_ERROR(WriteTo(gzip, *row, mesh));
    return gzip.Finish();
  });
}

absl::StatusOr<std::string> FormatMesh(const TriangleMesh& mesh, Format format) {
  MESHFRONT_ASSIGN_OR_RETURN(const FormatRow* row, FindWriter(format, ""));
  MESHFRONT_RETURN_IF_ERROR(CheckWritable(mesh));
  StringSink sink;
  MESHFRONT_RETURN_IF_ERROR(WriteTo(sink, *row, mesh));
  return sink.Take();
}

}  // namespace meshfront
