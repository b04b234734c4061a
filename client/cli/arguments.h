// The command line as it was typed, and what it means.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/io/mesh_io.h"
#include "meshfront/v1/options.pb.h"

namespace meshfront {

// Values of the flags that say how to mesh; a flag that was not given is empty. Texts, so that every mistake gets one sentence with the
// flag, the value and the rule.
struct MeshingFlags {
  using Text = std::optional<std::string>;
  Text rho, lod, eta, max_error, sizing, target_triangles, edge_length, min_edge, max_edge;
  Text crease_angle, features, attributes, region, blend, surface, mls_radius, fill_gaps;
  std::vector<std::string> seed_points;
  Text flips, smooth, fit, threads, repair;
};

// Flags of calls.
struct CallFlags {
  std::string server;  // empty: in process
  MeshingFlags::Text timeout;
  MeshingFlags::Text in_format, out_format;
};

struct RemeshArguments {
  std::string in, out;
  MeshingFlags meshing;
  CallFlags call;
  std::string stats, trace, picture, write_repaired, removed;  // paths, empty: not wanted
  std::string keep_session, session;                           // likewise
  MeshingFlags::Text session_revision;
  bool patch_only = false;
  bool update_session = false;
  bool quiet = false;
};

struct EstimateArguments {
  std::string in;
  MeshingFlags meshing;
  CallFlags call;
  bool json = false;
};

struct MeasureArguments {
  std::string out, reference;
  CallFlags call;  // in_format only
  bool json = false;
};

struct RenderArguments {
  std::string in, out;
  std::string view_of;                               // path, empty: of IN itself
  MeshingFlags::Text size, zoom, at, up, in_format;  // texts, for the same reason
};

// The options to send: what was given and nothing else. InvalidArgument in one sentence: a value out of its range, flags that
// contradict one another, or a flag that is documented but does nothing yet ("not yet").
absl::StatusOr<v1::RemeshOptions> ParseMeshingFlags(const MeshingFlags& flags);
// The faces that --region faces:FILE names, one number a line; empty for another region or none. InvalidArgument with the file and the
// line: it can't be read, or a line is no number.
absl::StatusOr<std::vector<uint32_t>> ReadRegionFaces(const MeshingFlags::Text& region);
// What --keep-session wrote to a file: the name, and whether the input had attributes, materials or nodes, which the program needs IN for.
struct SessionFile {
  std::string name;
  bool has_attributes = false;
};
inline constexpr char kSessionWithAttributes[] = "attributes";  // the word behind the name then
// InvalidArgument: it can't be read, or holds none. Reads 256 bytes at most.
absl::StatusOr<SessionFile> ReadSessionFile(const std::string& path);
// A whole number from 0 on; none when not given.
absl::StatusOr<std::optional<uint64_t>> ParseSessionRevision(const MeshingFlags::Text& revision);
// Seconds, > 0; infinity when not given.
absl::StatusOr<double> ParseTimeout(const MeshingFlags::Text& timeout);
// HOST:PORT with a port in 1..65535.
absl::Status CheckServerAddress(const std::string& address);
// The format of `path`: the flag's when given, else by its ending. `-` needs the flag, named `flag` in messages. kUnknown for a
// file to be read whose ending says nothing: its content may.
absl::StatusOr<Format> FormatFor(const std::string& path, const MeshingFlags::Text& format, const std::string& flag);

}  // namespace meshfront
