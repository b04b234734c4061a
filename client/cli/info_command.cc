#include <algorithm>
#include <iostream>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/commands.h"
#include "client/cli/input.h"
#include "client/cli/text.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"

namespace meshfront {
namespace {

void PrintContents(const std::string& path, const ReadResult& read) {
  const TriangleMesh& mesh = read.mesh;
  const Box3 box = BoundingBox(mesh);
  std::cout << absl::StrFormat("file        %s (%s)\n", path, std::string(FormatName(read.format)));
  if (mesh.IsPointSet()) {
    std::cout << absl::StrFormat("points      %s, %s normals\n", WithThousands(mesh.positions.size()),
                                 mesh.normals.empty() ? "without" : "with");
  } else {
    std::cout << absl::StrFormat("mesh        %s vertices, %s triangles\n", WithThousands(mesh.positions.size()),
                                 WithThousands(mesh.triangles.size()));
  }
  if (!box.empty()) {
    std::cout << absl::StrFormat("box         %s to %s, diagonal %g\n", PlaceText(box.min), PlaceText(box.max),
                                 box.Diagonal());
  }
  std::vector<std::string> attributes = mesh.dropped_attributes;
  for (std::string& name : NamesForMessage(mesh.attributes.channels)) attributes.push_back(std::move(name));
  if (!attributes.empty()) std::cout << "attributes  " << absl::StrJoin(attributes, ", ") << "\n";
}

void PrintTopology(const TopologyReport& t) {
  std::cout << absl::StrFormat("topology    %s components, %s boundary loops (%s edges), %s, %s, %s\n",
                               WithThousands(t.components), WithThousands(t.boundary_loops),
                               WithThousands(t.boundary_edges),
                               t.genus ? absl::StrFormat("genus %d", *t.genus) : "genus undefined",
                               t.manifold ? "manifold" : "not manifold", t.oriented ? "oriented" : "not oriented");
}

template <class IdType>
std::string Ids(const std::vector<IdType>& ids) {
  constexpr size_t shown = 8;
  std::vector<std::string> texts;
  for (size_t i = 0; i < std::min(shown, ids.size()); ++i) texts.push_back(absl::StrFormat("%d", ids[i].index()));
  if (ids.size() > shown) texts.push_back("…");
  return absl::StrJoin(texts, " ");
}

// Vertices that no triangle names stop nothing, but nobody wants them.
void PrintNotes(const TriangleMesh& mesh) {
  std::vector<bool> named(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexId v : t) {
      if (v.index() < named.size()) named[v.index()] = true;
    }
  }
  const size_t unreferenced = std::count(named.begin(), named.end(), false);
  if (unreferenced == 0) return;
  const size_t first = std::find(named.begin(), named.end(), false) - named.begin();
  std::cout << absl::StrFormat(
      "note        %s unreferenced vertices, which no triangle names; the first is vertex %d\n",
      WithThousands(unreferenced), first);
}

void PrintDefects(const DefectList& list) {
  std::cout << absl::StrFormat("defects     %s\n", list.total == 0 ? "none" : WithThousands(list.total));
  for (const Defect& defect : list.defects) {
    std::cout << "  " << defect.what;
    if (defect.position) std::cout << " at " << PlaceText(*defect.position);
    if (!defect.faces.empty()) std::cout << ", faces " << Ids(defect.faces);
    if (!defect.vertices.empty()) std::cout << ", vertices " << Ids(defect.vertices);
    std::cout << ": " << defect.message << "\n";
  }
  if (list.total > list.defects.size()) {
    std::cout << absl::StrFormat("  and %s more\n", WithThousands(list.total - list.defects.size()));
  }
}

}  // namespace

ExitCode RunInfo(const std::string& path, const CallFlags& flags) {
  const absl::StatusOr<Format> format = FormatFor(path, flags.in_format, "--in-format");
  if (!format.ok()) return Fail(ExitCode::kUsage, format.status());
  const absl::StatusOr<ReadResult> read = ReadInput(path, *format);
  if (!read.ok()) return Fail(ExitCodeOfRead(read.status()), read.status());
  PrintWarnings(read->warnings);
  PrintContents(path, *read);
  if (!read->mesh.IsPointSet()) PrintTopology(MeasureTopology(read->mesh));
  PrintDefects(FindDefects(read->mesh));
  if (!read->mesh.IsPointSet()) PrintNotes(read->mesh);
  return std::cout.flush() ? ExitCode::kDone
                           : Fail(ExitCode::kOutput, absl::InternalError("standard output can't be written"));
}

}  // namespace meshfront
