// Everything before the front: from the mesh as read to a surface, a guidance field and the fronts to start from. Shared by
// remeshing and estimating.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/field_builder.h"
#include "core/guidance/guidance_field.h"
#include "core/point_field.h"
#include "core/region_parts.h"
#include "core/remesh.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/mls_rims.h"
#include "core/surface/oriented_loop.h"
#include "core/surface/point_surface.h"

namespace meshfront {

// Gaps that were closed; of those that should have been, places on the rims of the ones that stay open.
struct GapReport {
  uint64_t filled = 0;
  std::vector<Vec3> left_open;
};

struct Preparation {
  InputReport input;
  ParametersInForce parameters;
  std::unique_ptr<RegionParts> region;     // none: the surface is that of all
  std::optional<RegionReport> everything;  // where a region was asked for that is all of the mesh
  std::shared_ptr<MeshSurface> surface;    // of what is to be meshed; null for a point set
  MeshAttributes attributes;               // of the surface's faces
  bool has_flat_normals = false;           // the attribute's are those of flat faces
  std::shared_ptr<FieldBuilder> builder;
  std::shared_ptr<PointSurface> points;  // of a point set; null for a mesh
  std::unique_ptr<PointFieldBuilder> point_builder;
  std::vector<RimCurve> rims;     // of the point set
  uint64_t lost_rims = 0;         // its curves that could not be followed
  std::vector<Vec3> lost_places;  // along them
  GapReport gaps;                 // in its surface
  double widened = 1;             // the supports of its samples, at the most
  std::optional<GuidanceField> field;
  std::vector<OrientedLoop> loops;
  std::vector<SourcePoint> seeds;
  std::vector<SourcePoint> more_seeds;  // of a point set, where a front left samples uncovered
  double parameter = 0;                 // the sizing's: rho, or the error bound or median edge in the surface's scale
  double predicted_triangles = 0;
  bool is_least_count = false;  // fewer triangles are wanted than any field makes
  int most_attempts = 16;       // of AdvanceInAttempts
  // All attempts at a point set look at about so many samples, which takes 15 to 45 s: those that have a say, for each candidate, and for
  // each triangle as often as for so many (attempts.cc).
  double most_samples_seen = 3e9;
  double scale = 1;  // the surface is the input times this power of two
  StageSeconds seconds;
  std::vector<std::string> warnings;  // of the input

  const Surface& any_surface() const { return points ? static_cast<const Surface&>(*points) : *surface; }
  // The largest curvature anywhere, and the box of the surface.
  double PeakCurvature() const;
  Box3 Box() const;
};

// The rows that say so.
void AddGaps(const GapReport& gaps, std::vector<RepairAction>& repairs);

// The error bound of eq. 7 for edges of `length` at the parameters in force: with the angle in force, so that a uniform length is
// bounded by what it is; where the error is held constant, that.
double ErrorBoundInForce(const Preparation& preparation, double length, double max_curvature);

// The stages up to the first triangle. Same errors as Remesh. `left`: faces of a region's whole mesh, as it is after repair, that are not in
// the region though its shape has them, one flag each; none: no such faces.
absl::StatusOr<Preparation> Prepare(Problem problem, const Context& context, const std::vector<bool>& left = {});

// The surface of a point set with supports that are wider by `factor` around places, or everywhere where there are none (MlsSamples),
// with its field and initial fronts. False: they are as wide as they may be.
absl::StatusOr<bool> WidenSupports(absl::Span<const Vec3> places, double factor, std::optional<uint64_t> count,
                                   Preparation& preparation, const Context& context);

// The same with weights as wide as the supports around the places, or everywhere where there are none. False: no weight is narrower there.
absl::StatusOr<bool> RoundEdges(absl::Span<const Vec3> places, std::optional<uint64_t> count, Preparation& preparation,
                                const Context& context);

// Field and initial fronts again: with edges half as long at some places and, as eta has it, around them; and for a predicted number
// of triangles, where one is given. The errors of Remesh.
absl::Status PrepareAgain(absl::Span<const Vec3> finer_at, std::optional<uint64_t> count, Preparation& preparation,
                          const Context& context);

// A preparation as it is before the first attempt, so that every level of detail begins there. Cheap: the surface is shared.
class LevelStart {
 public:
  explicit LevelStart(const Preparation& p)
      : input_(p.input),
        parameters_(p.parameters),
        surface_(p.surface),
        builder_(p.builder),
        points_(p.points),
        rims_(p.rims),
        lost_rims_(p.lost_rims),
        lost_places_(p.lost_places),
        gaps_(p.gaps),
        seeds_(p.seeds) {}

  // Surface, seeds and options as they were, with another rho, and the field and the initial fronts for it: those that a problem with
  // that rho has, if it is larger than all before. `seconds` of the preparation are of this alone. The errors of Remesh.
  absl::Status Prepare(double rho, Preparation& preparation, const Context& context) const;

 private:
  InputReport input_;
  ParametersInForce parameters_;
  std::shared_ptr<MeshSurface> surface_;
  std::shared_ptr<FieldBuilder> builder_;
  std::shared_ptr<PointSurface> points_;
  std::vector<RimCurve> rims_;
  uint64_t lost_rims_;
  std::vector<Vec3> lost_places_;
  GapReport gaps_;
  std::vector<SourcePoint> seeds_;
};

}  // namespace meshfront
