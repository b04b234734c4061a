// The apex of a free triangle on a mesh: by walking, and by searching the connected faces near by where the walk fails.
#pragma once

#include <optional>

#include "absl/types/span.h"
#include "core/surface/mesh_walk.h"
#include "core/surface/surface.h"

namespace meshfront {

// A front edge a → b with the two distances wanted from it, and the circle that they leave for the apex.
struct ApexQuery {
  const SourcePoint& a;
  const SourcePoint& b;
  Vec3 normal;  // of the front: unit, the mean of the two ends'
  PlacementCircle circle;
};
// Nothing when the spheres around the ends do not meet, or the front's normal runs along the edge.
std::optional<ApexQuery> CreateApexQuery(const SourcePoint& a, const SourcePoint& b, double radius_a, double radius_b);

// The cosine between the normals of the triangle (b, a, apex) and of the front; −1 when the apex is not on the open side or the
// triangle has no area, or when `surface_normal` (at the apex, any length) turns away from the triangle: another sheet.
double FrontAgreement(const ApexQuery& query, const Vec3& apex, const Vec3& surface_normal);

// Follows the section of the surface with the circle's plane, from below the circle's centre, inside the ball that holds edge and
// circle and not farther along the surface than kMaxDetour, and returns the crossing with the best FrontAgreement of at least
// kMinFrontAgreement. `normals` are those of the vertices. 50 ns a face; uses scratch memory of the calling thread.
std::optional<FaceHit> SearchApex(const FaceView& mesh, absl::Span<const Vec3> normals, const ApexQuery& query);

// The blend of a face's vertex normals at a point of it, not normalised.
Vec3 BlendNormals(const FaceView& mesh, absl::Span<const Vec3> normals, const FaceHit& hit);

}  // namespace meshfront
