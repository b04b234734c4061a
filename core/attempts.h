// The front, and what is made again where it came out wrong.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/front/advancing_front.h"
#include "core/mesh/holding_sink.h"
#include "core/mesh/mesh_sink.h"
#include "core/mesh/topology.h"
#include "core/missed_places.h"
#include "core/preparation.h"
#include "core/surface/surface.h"

namespace meshfront {

// Of the number of triangles wanted: results nearer to it are not made again, and not warned of.
inline constexpr double kCountPromise = 0.03;

// What came of one run of the front, and where it is wrong. In the surface's scale.
struct Attempt {
  FrontReport front;
  ParametersInForce parameters;
  double parameter = 0;  // the sizing's, as in Preparation
  std::vector<Vec3>
      intersections;  // where it meets itself though the surface does not within the error bound, one a pair
  std::vector<Vec3> flat_triangles;  // where one has no area
  bool has_other_topology = false;   // than the input: components, boundary loops or genus; only where it is whole
  bool keeps_creases = false;        // though they were not to be kept: no front passed over them
  std::vector<HeldPiece> pieces;     // what was held of it; none afterwards
  double bound = 0;                  // of the error: how far from where the surface meets itself it may, too
  // Of a point set, whose surface is another where supports were widened.
  std::vector<SourcePoint> uncovered;  // a place in each of its parts that the mesh does not cover all of
  uint64_t lost_rims = 0;              // its rims that could not be followed
  std::vector<Vec3> lost_places;       // along them
  GapReport gaps;                      // between them
  double widened = 1;                  // its supports, at the most
  TopologyReport points;               // its parts and rims
  double samples_seen = 0;             // about, by all fronts up to this one
  double peak_curvature = 0;
  MissedPlaces missed;                         // of a mesh, that few triangles pass over
  uint64_t thinned_from = 0;                   // triangles, before some were taken out (thinning.h); 0: none were
  uint64_t own_components = 0, own_faces = 0;  // of the input, handed on as they came in (own_faces.h)

  size_t fault_count() const {
    return front.open_places.size() + intersections.size() + flat_triangles.size() + lost_rims + uncovered.size() +
           missed.places.size() + has_other_topology;
  }
  // The places of all of them.
  std::vector<Vec3> Faults() const;
};

// The topology of what a front made, from the counts that it kept: V − E + F with E = (3F + rim) / 2.
TopologyReport TopologyOf(const FrontReport& front);
// Whether components, boundary loops or genus differ.
bool HasOtherTopology(const TopologyReport& output, const TopologyReport& input);

// Advances the fronts of a preparation into the sink, as AdvanceFront does, with its errors. Results with creases, or with rims that
// lie close to something (close_curves.h), or on ground where one edge in 200 turns sharply, or of inputs that were no surface before
// repair or whose sheets are closer than their edges can be short, are held back up to 524,288 triangles or 8 for each face of the input,
// those with other rims up to 6,000, and wholly those of a region and those of which up to 6,000 are predicted, 50,000 where fewer are wanted than any field makes. While nothing went on they are made again, at most six times: where creases were not to be
// kept, with those of more than 40 degrees; where the topology is not the input's, or there are more than 1,000 faults, with an eta of 1.2
// if it was larger; where there are fewer, with edges half as long around them, up to three times and not on such ground; then with the
// input's faces cut loose around the faults (loose_faces.h), unless a shortest edge is asked for; and up to three times for as many more or
// fewer triangles as came too few or too many when a number was wanted (off by more than 3 %). Where so few
// were wanted that all is held, faults (parts of the surface that nothing passes over are some, missed_places.h) are met by edges half as
// long around them and by 1.6 times as many triangles in turn. The attempt with the fewest faults goes on, of equals the one nearest to
// the count, and of these few the one nearest above it, of which triangles are taken out again (thinning.h); components that are wrong in it are the input's own faces (own_faces.h), unless a shortest edge
// or a region is asked for. Of a region there are no more attempts once the front was taken back all over, or 50,000 triangles were made
// in vain: its faces may stay as they are (region_faults.h). Of point sets all are held that fit; they are made again at most five times: with shorter edges once, with
// wider supports around faults twice, and with wider ones everywhere, at once where the front folded over itself (FrontReport::ran_away),
// until two in a row have hardly fewer faults, or all have looked at 3e9 samples. Progress begins anew with each. Changes the preparation.
absl::StatusOr<Attempt> AdvanceInAttempts(Preparation& preparation, MeshSink& sink, const Context& context);

}  // namespace meshfront
