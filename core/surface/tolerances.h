// Every number of this room that stands for "nearly".
#pragma once

#include <cstddef>
#include <cstdint>

namespace meshfront::surface_tolerances {

// A hit may lie outside its face by this barycentric weight: rounding at a shared edge must lose it for neither face.
inline constexpr double kFaceSlack = 1e-9;
// Weights below this lie on the edge: the rim of an open mesh.
inline constexpr double kOnEdge = 1e-12;
// Two spheres whose circle is smaller than this, relative to the radius, only touch.
inline constexpr double kTouching = 1e-10;
// Sine of the angle between a front edge and the front's normal below which no side is the open one.
inline constexpr double kMinEdgeToNormalSine = 1e-6;
// Squared sine below which a face is parallel to the circle's plane.
inline constexpr double kParallelSquared = 1e-24;
// A free triangle's normal agrees with the front's by at least this cosine (78°).
inline constexpr double kMinFrontAgreement = 0.2;
// And with the surface's at the apex by more than this: otherwise the apex lies on another sheet.
inline constexpr double kMinApexAgreement = 0.0;
// Steps of the walk to a target before the careful descent takes over: the longest ways are a few hundred faces.
inline constexpr uint32_t kMaxWalkSteps = 4096;
// Steps of the walk along the circle before the search takes over; beyond a dozen it runs in circles.
inline constexpr int kMaxCircleSteps = 64;
// Diagonals of a mesh: their fourth powers, which the fits form, stay well inside the range of double.
inline constexpr double kMinDiagonal = 1e-70, kMaxDiagonal = 1e70;
// A blend of unit normals shorter than this has no direction.
inline constexpr double kCancelledNormal = 1e-3;
// How much a curvature of 1 / (component's diagonal) speaks against a seed there.
inline constexpr double kSeedFlatness = 0.1;
// The search goes no farther along the surface than this many radii of the ball around the circle.
inline constexpr double kMaxDetour = 2.5;
// Faces that one search may visit: bounds the time where an edge is long against the input.
inline constexpr size_t kMaxSearchFaces = 4096;
// Faces around the foot of the circle that are looked at for one in the circle's plane.
inline constexpr size_t kMaxFootFaces = 64;

// Two places of a surface face each other when the cosine between their normals is below this.
inline constexpr double kOpposed = -0.2;
// Rounding of the product of two unit vectors, with room.
inline constexpr double kDotSlack = 1e-12;
// They are different sheets when the way along the surface is longer than this many distances: a limb (π/2) and the walls of a
// groove wider than 37° (3) are left to the curvature.
inline constexpr double kOtherSheetDetour = 3;
// A vertex nearer to a probe than this part of the probe's search limit needs no probe of its own.
inline constexpr double kProbeReach = 0.25;
// Faces looked at for such a way; where it is not found among them it is long in faces too.
inline constexpr size_t kMaxDetourFaces = 200;

// A way over the surface: its length in parts of the distance between its ends, its pieces, how near to a side of a face (in parts
// of that distance) an end counts as on it, and how many faces may meet in an end.
inline constexpr double kMaxWayPerDistance = 4;
inline constexpr size_t kMaxWayPieces = 400;
inline constexpr double kOnSideOfWay = 1e-7;
inline constexpr size_t kMaxFacesAtAPoint = 64;

// Faces looked at over one triangle.
inline constexpr size_t kMaxShadowFaces = 4096;

// Pairs of faces that meet which are remembered with their places, 50 MB: beyond, a mesh is more knot than surface.
inline constexpr size_t kMaxSelfMeetings = 200000;

// Passes of averaging over rings for each time that the input has as many triangles again as the output: n passes reach √(n/2) edges.
inline constexpr double kPassesPerCoarser = 1.5, kMaxPasses = 64;
// A vertex's curvature in parts of the average around it, at most.
inline constexpr double kMostPerAverage = 2.0;

// Of point sets: fewest samples; neighbours that tell how far apart samples are; fewest samples of a part; cosines of normals within one patch, and of a sample
// that a place with some normal may belong to; and how far a patch answers for around its samples, in parts of their supports.
inline constexpr size_t kLeastMlsSamples = 4, kSpacingNeighbours = 12, kLeastComponent = 12;
inline constexpr double kSamePatch = 0.5, kLikeNormal = 0.0, kPatchMargin = 0.25;
// And how much farther than that patch, and a support, another one may be where a place is not its own: in a soup whose normals disagree the
// search for one that agrees went through all samples.
inline constexpr double kFarthestPatch = 2;
// Neighbours are on one sheet when the cosine between their normals is above this (an edge of 32° between its faces still is one), and
// opposed samples belong together when the way from one to the other is at most so many supports long.
inline constexpr double kLinked = -0.85, kMostWayPerSupport = 1.5;
// Where spacings are measured among more neighbours, parts of fewer than this part of them are no parts.
inline constexpr size_t kNeighboursPerLeast = 4;
// A sample's weight is narrower where its neighbours lie off their planes by more than so many times the median, and than this part of
// the spacing (noise alone has 1.6 times at most); how much more, in parts of that, narrows it to the last of these parts of the support.
inline constexpr double kSharpBendPerMedian = 1.8, kLeastSharpBend = 0.06, kSharpBendRange = 0.4,
                        kNarrowestRadius = 0.65;
// What is less sharp is rounding. And the part of the half n(x)·(x − a(x)), which is ½ elsewhere, where weights are narrowest.
inline constexpr double kLeastSharpness = 1e-9, kCentreShareAtEdges = 0.2;
// How far around a place supports are widened, in supports.
inline constexpr double kWidenedReach = 6;
// Of the support: a step of Newton's method below this is the last, as the next would be its square; and of the residual, how far its
// tangential part may be from a foot's.
inline constexpr double kLastMlsStep = 1e-4, kFootResidual = 1e-2;
inline constexpr int kMaxMlsSteps = 12, kMaxFootRounds = 3;
// Of an angle on the circle of an apex, when the last step is taken; and the longest step.
inline constexpr double kLastCircleStep = 1e-6, kLongestCircleStep = 0.4;
// Curvatures in parts of 1 / support, at most: what bends more than around a spacing is between the samples, and nobody's.
inline constexpr double kMostCurvaturePerSupport = 4;
// Sides of a triangle are divided in so many where the surface of a point set is compared with it.
inline constexpr int kFarLattice = 4;
// The data end where the centroid of what has a say lies this part of the support beside the place: at a straight end it is 0.235, among
// samples at random the chance of 0.35 is below 1e-9.
inline constexpr double kOutside = 0.35;
// Of the plane of a polynomial fit: steps of Newton's method, the last and the longest one (radians, or parts of the support); how far it
// may lie from the place, in supports (beyond 0.4 weights fall faster than distances grow); and the determinant of a plane that is none.
inline constexpr int kMaxPlaneSteps = 8;
inline constexpr double kLastPlaneStep = 1e-3, kLongestPlaneStep = 0.5, kMostPlaneOffset = 0.35,
                        kLeastPlaneMinor = 1e-9;
// More samples than a polynomial has terms, and the least pivot of its normal equations in parts of the sum of weights.
inline constexpr int kSpareMlsSamples = 2;
inline constexpr double kLeastTermPivot = 1e-7;
// The last step to the surface of such fits in parts of the support, whose rest is about its square by the curvature, and the last one
// on the circle of an apex, radians.
inline constexpr double kLastFitStep = 2e-3, kLastFitAngle = 1e-4;
}  // namespace meshfront::surface_tolerances
