// The numeric choices of this room, each with its unit and reason.
#pragma once

#include <cstddef>
#include <cstdint>

namespace meshfront {

// A vertex of a curve is a corner when its chords turn by more than 45° both at half the local edge length and at the whole:
// a zig-zag of single edges turns at one scale only.
inline constexpr double kCornerCosine = 0.70710678118654752440;
// Vertices looked at on each side when a chord is sought: bounds the work where a curve is very fine against g.
inline constexpr size_t kChordReach = 64;
// A chord may leave skipped parts of the curve at most this far aside, as a share of its length or of g: the sagitta of an arc of
// 1.5 radians. Sizing samples along curves keep it below that; this is the net under noise and hairpins.
inline constexpr double kMaxSagittaShare = 0.2;
// Between nodes of the feature graph: of the chord alone, the sagitta of an arc of one radian; and how near, as a share of the chord
// that it divides, a vertex may lie to the next.
inline constexpr double kMaxCreaseSagittaShare = 0.125;
inline constexpr double kMinCreaseAnchorDistance = 0.2;
inline constexpr double kMinSagittaAnchorDistance =
    0.1;  // … where the vertex lies beyond the sagitta that is asked for
// Rounds in which such places get a vertex, by the shape alone, and where chords may lie only so far from the curve.
inline constexpr int kMaxRefinements = 4, kMaxRefinementsForSagitta = 8;
// Corners, and vertices added in that way, are at least this share of g apart along the curve, lest front edges become so
// short that no good triangle grows from them.
inline constexpr double kMinAnchorDistance = 0.6;
// More points than this on one curve are refused: the field is finer than any output that could be wanted.
inline constexpr size_t kMaxCurvePoints = size_t{1} << 22;
inline constexpr size_t kStopInterval = 4096;  // steps between two looks at the context: below a millisecond

inline constexpr size_t kCornerStopInterval = 256;  // the same where every step looks along four chords

// The circle that tells a curve's curvature is fitted to this many vertices on each side.
inline constexpr size_t kCurvatureReach = 3;
// The fit's determinant below which the curve folds back, in units of the mean edge; one for three points on a line.
inline constexpr double kMinDeterminant = 1e-9;
// Curvature is at most 1 / (this × mean edge): a polyline cannot tell anything sharper than a turn within two edges.
inline constexpr double kMinRadiusInEdges = 0.5;
// The sides of a corner are straight when chord / arc over the fit's reach is at least this.
inline constexpr double kStraightShare = 0.95;
// Chords are tried from long to short by this factor, at most so many (down to a millionth).
inline constexpr double kChordScale = 0.8;
// Zig-zags of a rim are followed down to its edges, but not below this many ideal lengths of a circle whose radius is the edge:
// what a coarse angle would not resolve on the surface it need not resolve on the rim.
inline constexpr double kIdealPerEdgeCircle = 1.6;
inline constexpr int kMaxChordScales = 64;
// Vertices looked at under one chord: about so many where there are more, and on one side never more than kMaxWindow, wherever
// they crowd.
inline constexpr size_t kWindowVertices = 64;
inline constexpr size_t kMaxWindow = 256;
inline constexpr size_t kChordStopInterval = 16;  // vertices between two looks at the context while chords are tried
// Ideal length on a curve is at most its length divided by this: g is l/η there, so a small hole gets about five vertices.
inline constexpr double kMinEdgesPerLoop = 4;
// A place of a rim is at a bend, not beside a strip, where the way along the rim to the other side is at most this many widths: at
// corners wider than 28°, in round and square patches, in rectangles of up to 3 : 1.
inline constexpr double kStripDetour = 4;
// Nor in a wedge: the rims meet at this angle or more (4°; sine), and the way between them along the rim is about what it is on straight
// sides to the tip and back. A field that follows the widths of wider wedges rises too steeply; its finest place would be the tip.
inline constexpr double kMinWedgeSine = 0.07;
inline constexpr double kMinWedgeWay = 0.5;
inline constexpr double kMaxWedgeWay = 3;
// Widths are looked for at places at most so many widths apart, and with at most so many pieces of an edge, each halved so often.
inline constexpr double kWidthSpacing = 4;
inline constexpr int kMaxWidthPieces = 64;
inline constexpr int kMaxWidthHalvings = 8;
inline constexpr int kMaxWidthFaces = 256;  // faces that a line across a patch may pass
// Gaps in a crease are bridged over edges that turn by at least this part of the angle …
inline constexpr double kWeakCrease = 0.5;
inline constexpr int kMaxBridge = 6;                // … so many of them
inline constexpr double kBridgeStraightness = 0.7;  // … each within 45° of the one before (cosine)
// A line that starts at a crease and ends inside a patch is a crease that fades out where its last edges, so many and so much of the
// diagonal, are straight (mean cosine: 18°); it is followed over edges that turn by at least this part of the angle.
inline constexpr uint32_t kFadeEdges = 8;
inline constexpr double kFadeOfDiagonal = 0.02;
inline constexpr double kFadeStraightness = 0.95;
inline constexpr double kFadedCrease = 0.25;
// A line from crease to crease is one itself, however faint, down to kFadedCrease, where it has so many edges and so much of the
// diagonal, and stands out: edges around it turn by at most this part of it. Facets of a cylinder don't.
inline constexpr uint32_t kFaintEdges = 3;
inline constexpr double kFaintOfDiagonal = 0.01;
inline constexpr double kFlatBesideFaint = 0.5;
// A face lower than this part of its longest side has no normal of its own, whatever the diagonal.
inline constexpr double kSliverHeight = 1e-4;
// A hair is a face lower than this part of its longest side and of the diagonal; chains of so many are looked through.
inline constexpr double kHairAspect = 0.1;
inline constexpr double kHairOfDiagonal = 5e-4;
inline constexpr int kMaxHairs = 4;

// Specks (specks.h). A cluster of small patches inside one large patch, the sea, is one
// … if it lies within this part of the diagonal of the mesh, and the sea has more faces than that;
inline constexpr double kSpeckOfDiagonal = 0.005;
inline constexpr uint32_t kIslandsSea = 150;
// … or, of at most so many faces in all, with sides that are not shorter than this part of those around it,
inline constexpr uint32_t kMaxSpeckFaces = 1000;
inline constexpr double kSpeckFineness = 0.25;
//     if its creases zigzag (mean cosine of the turns from edge to edge: 32°), and it has at most so many faces or the sea so many
//     times its faces;
inline constexpr double kZigzagCosine = 0.85;
inline constexpr uint32_t kSpeckFaces = 40;
inline constexpr uint32_t kSeaPerSpeck = 100;
//     if two creases leave a vertex within 15° of each other (cosine), which would be a needle of the output, and the sea is as
//     large;
inline constexpr double kWedgeCosine = 0.966;
//     or if it has few faces, however it runs, and the sea so many times as many;
inline constexpr uint32_t kSeaPerSmoothSpeck = 1000;
// but, unless nobody sees it, none that somebody meant, as pockets and bosses of machined parts: the sea is one plane all around it,
// everything beside the sea turns by more than 20° (sine) from that, and by what rounding can have made of it, and a patch of two faces or
// more is one plane as well. Noise has neither. A plane is what turns by no more than this angle (radians: 0.008°) or, where that is more,
// than the rounding of the coordinates can have made of it, up to 3°, beyond which it could be anything.
inline constexpr double kFlatAngle = 1.4e-4;
inline constexpr double kMostRoundedAngle = 0.05;
inline constexpr double kMeantTurnCosine = 0.94;
inline constexpr double kMeantTurnSine = 0.3411744421846396;
// How coordinates were rounded (coordinate_rounding.h) is told by so many vertices or twice as many, of whose numbers at least this share
// is as it was written: repair may have made some.
inline constexpr size_t kVerticesForRounding = 500;
inline constexpr double kShareAsWritten = 0.98;
// Edges of no more than so many of the last digits: what such digits make of a shape would be seen at once.
inline constexpr double kSpacingsOfAnEdge = 8;

// A curve passes close to what lies within this part of an edge's length around its middle; and a walk has reached a place when it ends
// within this part of that.
inline constexpr double kCloseToCurve = 0.5;
inline constexpr double kReached = 1e-3;
// Around an edge of a curve, in parts of kCloseToCurve's length; and faces looked at there.
inline constexpr double kAroundCurve = 6;
inline constexpr size_t kMaxFacesAroundCurve = 20000, kMaxFacesAroundCurves = 1000000;  // of one, and of all
inline constexpr uint32_t kFacesBetweenChecks = 1024;

// Values of attributes on the two sides of an edge differ by more than this part of their range, colours by half a step of 8 bits: what
// exporters round away makes no seam.
inline constexpr float kSeamPerRange = 1e-4f, kColourSeam = 0.5f / 255;
// Edges at a vertex that differ at this end only: a seam runs out, or two do; more are the pole of a globe.
inline constexpr uint8_t kMostEndsOfSeams = 2;
// Faces that hang together and are unfolded the same way; fewer are flaws of the unfolding.
inline constexpr uint32_t kLeastMirroredFaces = 16;
inline constexpr double kHardNormalCosine = 0.9961946981;  // 5°
// Share of the edges, creases left out, at which normals break where they are those of flat faces.
inline constexpr double kFlatShare = 0.2;

// Polylines, in parts of the diagonal: how far from the surface they may lie; from where on a point is told to have been moved; within
// what a point is at a vertex or on an edge that is there; and how far a vertex of the input may lie beside a segment to be taken for a
// place on it, which is also bounded by a part of the edge, since it saves slivers where the mesh is fine.
inline constexpr double kLineReach = 0.01;
inline constexpr double kMovedPoint = 1e-6;
inline constexpr double kSamePoint = 5e-7;
inline constexpr double kSnapPerDiagonal = 1e-4;
inline constexpr double kSnapPerEdge = 0.05;
// Where lines are clipped to some faces: steps along a segment, in parts of those faces' mean edge; the most steps; and the halvings of a
// step that tell where a line leaves them.
inline constexpr double kClipStepPerEdge = 0.5;
inline constexpr double kMostClipSteps = 1e5;
inline constexpr int kClipHalvings = 20;
// Segments are halved so often where the surface bends away from the plane that they lie in.
inline constexpr int kMostHalvings = 8;

}  // namespace meshfront
