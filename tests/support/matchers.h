// GoogleMock matchers for statuses and for what a mesh is. A failed one says what it found.
#pragma once

#include <ostream>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/mesh/self_intersection.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_mesh.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace absl {
// What GoogleTest prints where it would print the bytes otherwise; found by the type's namespace.
template <class T>
void PrintTo(const StatusOr<T>& result, std::ostream* out) {
  *out << result.status();
}
}  // namespace absl

namespace meshfront::testing {

inline const absl::Status& StatusOf(const absl::Status& status) { return status; }
template <class T>
const absl::Status& StatusOf(const absl::StatusOr<T>& result) {
  return result.status();
}

// For absl::Status and absl::StatusOr<T> alike.
MATCHER(IsOk, negation ? "is an error" : "is OK") {
  *result_listener << StatusOf(arg).ToString();
  return StatusOf(arg).ok();
}
MATCHER_P2(StatusIs, code, substring,
           (negation ? "is not " : "is ") + absl::StatusCodeToString(code) + " saying \"" + std::string(substring) +
               "\"") {
  *result_listener << StatusOf(arg).ToString();
  return StatusOf(arg).code() == code && std::string(StatusOf(arg).message()).find(substring) != std::string::npos;
}

inline std::string Describe(const TopologyReport& t) {
  std::string text = std::to_string(t.vertices) + " vertices, " + std::to_string(t.triangles) + " triangles, " +
                     std::to_string(t.components) + " components, " + std::to_string(t.boundary_edges) +
                     " boundary edges in " + std::to_string(t.boundary_loops) + " loops, genus " +
                     (t.genus ? std::to_string(*t.genus) : "undefined");
  if (!t.manifold) text += ", not manifold";
  if (!t.oriented) text += ", not oriented";
  return text;
}

// For a TriangleMesh or a TopologyReport.
inline TopologyReport TopologyOf(const TriangleMesh& mesh) { return MeasureTopology(mesh); }
inline TopologyReport TopologyOf(const TopologyReport& report) { return report; }

MATCHER(IsManifold, negation ? "is not an oriented manifold" : "is an oriented manifold") {
  const TopologyReport t = TopologyOf(arg);
  *result_listener << Describe(t);
  return t.triangles > 0 && t.manifold && t.oriented;
}
MATCHER(IsClosedManifold, negation ? "is not a closed oriented manifold" : "is a closed oriented manifold") {
  const TopologyReport t = TopologyOf(arg);
  *result_listener << Describe(t);
  return t.closed && t.manifold && t.oriented;
}
// Summed over components; fails where the genus is undefined.
MATCHER_P(HasGenus, genus, (negation ? "has not genus " : "has genus ") + std::to_string(genus)) {
  const TopologyReport t = TopologyOf(arg);
  *result_listener << Describe(t);
  return t.genus.has_value() && *t.genus == static_cast<int64_t>(genus);
}
MATCHER_P(HasBoundaryLoops, loops, (negation ? "has not " : "has ") + std::to_string(loops) + " boundary loops") {
  const TopologyReport t = TopologyOf(arg);
  *result_listener << Describe(t);
  return t.boundary_loops == static_cast<uint64_t>(loops);
}
MATCHER_P(HasComponents, components, (negation ? "has not " : "has ") + std::to_string(components) + " components") {
  const TopologyReport t = TopologyOf(arg);
  *result_listener << Describe(t);
  return t.components == static_cast<uint64_t>(components);
}
// No two triangles have more in common than a corner or a side, exactly.
MATCHER(HasNoSelfIntersection, negation ? "intersects itself" : "does not intersect itself") {
  const absl::StatusOr<SelfIntersections> found = FindSelfIntersections(arg, 5, {});
  if (!found.ok()) {
    *result_listener << found.status().ToString();
    return false;
  }
  *result_listener << found->pairs << " pairs of faces meet";
  for (const auto& [a, b] : found->first_pairs) *result_listener << ", " << a.index() << " and " << b.index();
  return found->pairs == 0;
}

}  // namespace meshfront::testing
