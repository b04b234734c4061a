#include "core/features/boundary.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/curve.h"
#include "core/features/feature_graph.h"
#include "core/features/tolerances.h"

namespace meshfront {
namespace {

using Rim = std::vector<uint32_t>;  // half-edges, the mesh on their left

std::vector<Rim> RimsOf(const MeshSurface& surface) {
  bool has_rim = false;
  for (uint32_t c = 0; c < surface.component_count() && !has_rim; ++c) has_rim = surface.ComponentHasBoundary(c);
  if (!has_rim) return {};
  std::vector<Rim> rims = FindBoundaryLoops(surface.adjacency());
  // A manifold has no shorter ones; nothing could be grown from them.
  std::erase_if(rims, [](const Rim& rim) { return rim.size() < 3; });
  return rims;
}

Curve CurveOf(const MeshSurface& surface, const Rim& rim) {
  std::vector<Vec3> points;
  points.reserve(rim.size());
  for (uint32_t h : rim) points.push_back(surface.mesh().PositionAt(OriginOf(surface.mesh(), h)));
  return Curve(std::move(points));
}

// The place at share t of a half-edge, as the surface knows it.
SourcePoint PlaceOn(const MeshSurface& surface, uint32_t h, double t) {
  if (t == 0) return surface.AtVertex(OriginOf(surface.mesh(), h));
  double weights[3] = {0, 0, 0};
  weights[h % 3] = 1 - t;
  weights[(h + 1) % 3] = t;
  return surface.AtFace(FaceId(FaceOfHalfEdge(h)), weights[1], weights[2]);
}

// Puts the rims' loops together from the curves of the feature graph.
class LoopBuilder {
 public:
  LoopBuilder(const MeshSurface& surface, std::vector<Rim> rims, const SagittaLimits& limits)
      : surface_(surface), rims_(std::move(rims)), limits_(limits), graph_(surface) {}

  absl::StatusOr<std::vector<OrientedLoop>> Build(const GuidanceField& field, const Context& context) {
    for (const Rim& rim : rims_) runs_.push_back(RunsOf(rim));
    FindLeastPoints();
    FindTwins();
    points_.resize(graph_.curves().size());
    places_.resize(graph_.curves().size());
    for (size_t c = 0; c < graph_.curves().size(); ++c) {
      MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
      MESHFRONT_RETURN_IF_ERROR(Divide(c, field, context));
    }
    MESHFRONT_RETURN_IF_ERROR(SplitTwins(field, context));
    NumberJoints();
    std::vector<OrientedLoop> loops;
    for (size_t i = 0; i < rims_.size(); ++i) loops.push_back(LoopOf(runs_[i]));
    for (const auto& [u, v] : surface_.taken()) loops[0].taken.push_back({node_joints_.at(u), node_joints_.at(v)});
    return loops;
  }

 private:
  // A curve as a rim passes through it.
  struct Run {
    uint32_t curve = 0;
    bool forward = true;
  };
  // An earlier curve through the same places.
  struct Twin {
    uint32_t curve = kNoHalfEdge;  // none
    bool forward = true;           // it runs the same way
  };
  // A point on its way into a loop, in the direction of the rim.
  struct Passed {
    SourcePoint place;
    uint32_t joint = kNoJoint;
    bool on_crease = false;  // the edge that leaves it
  };

  std::vector<Run> RunsOf(const Rim& rim) const;
  void FindLeastPoints();
  void FindTwins();
  absl::Status Divide(size_t curve, const GuidanceField& field, const Context& context);
  void DivideLike(size_t curve, const Twin& twin);
  absl::Status SplitTwins(const GuidanceField& field, const Context& context);
  void NumberJoints();
  Passed PassPoint(const Run& run, size_t i) const;
  OrientedLoop LoopOf(const std::vector<Run>& runs) const;

  const MeshSurface& surface_;
  const std::vector<Rim> rims_;
  const SagittaLimits limits_;
  const FeatureGraph graph_;
  std::vector<std::vector<Run>> runs_;           // of each rim
  std::vector<size_t> least_;                    // points of each curve
  std::vector<Twin> twins_;                      // of each curve
  std::vector<bool> has_place_;                  // of each curve: what others divide alike
  std::vector<std::vector<CurvePoint>> points_;  // of each curve
  std::vector<std::vector<Vec3>> places_;        // of these points
  std::vector<uint32_t> first_joint_;            // of each curve; its points' joints follow each other
  std::map<uint32_t, uint32_t> node_joints_;     // of each node, by its vertex
};

std::vector<LoopBuilder::Run> LoopBuilder::RunsOf(const Rim& rim) const {
  size_t first = 0;  // a rim begins at a node, where it has one
  const auto starts_at_node = [&](size_t i) {
    return graph_.IsNode(surface_.OriginalOf(OriginOf(surface_.mesh(), rim[i])));
  };
  while (first < rim.size() && !starts_at_node(first)) ++first;
  std::vector<Run> runs;
  for (size_t i = 0; i < rim.size();) {
    const CurveSegment at = graph_.SegmentOf(rim[(first + i) % rim.size()]);
    runs.push_back({at.curve, at.forward});
    i += graph_.curves()[at.curve].forward.size();
  }
  return runs;
}

// Two curves between the same nodes may not both be one edge, nor a curve from a node to itself fewer than three.
void LoopBuilder::FindLeastPoints() {
  const auto& curves = graph_.curves();
  least_.assign(curves.size(), 1);
  using Ends = std::pair<uint32_t, uint32_t>;
  const auto ends_of = [](const FeatureCurve& c) { return Ends(std::minmax(c.start(), c.end())); };
  std::map<Ends, size_t> between;
  for (const FeatureCurve& c : curves) {
    if (!c.closed) ++between[ends_of(c)];
  }
  for (const Ends& ends : surface_.taken()) ++between[ends];
  for (size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].closed || curves[i].is_border) continue;
    if (curves[i].start() == curves[i].end())
      least_[i] = 3;
    else if (between[ends_of(curves[i])] > 1)
      least_[i] = 2;
  }
}

// Open curves through the same places, in either direction: sheets touch there, and both are to have the same vertices.
void LoopBuilder::FindTwins() {
  const auto& curves = graph_.curves();
  twins_.resize(curves.size());
  has_place_.resize(curves.size());
  const auto less = [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  const auto less_path = [&](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
  };
  std::map<std::vector<Vec3>, std::pair<uint32_t, bool>, decltype(less_path)> first(less_path);
  for (uint32_t i = 0; i < curves.size(); ++i) {
    if (curves[i].closed) continue;
    std::vector<Vec3> path;
    for (const uint32_t v : curves[i].vertices) path.push_back(surface_.mesh().positions[v]);
    std::vector<Vec3> back(path.rbegin(), path.rend());
    const bool turned = less_path(back, path);
    const auto [at, is_first] = first.try_emplace(turned ? std::move(back) : std::move(path), i, turned);
    if (is_first) continue;
    const auto [other, other_turned] = at->second;
    twins_[i] = {other, turned == other_turned};
    has_place_[i] = has_place_[other] = true;
    least_[other] = std::max(least_[other], least_[i]);
  }
}

void LoopBuilder::DivideLike(size_t curve, const Twin& twin) {
  points_[curve] = points_[twin.curve];
  places_[curve] = places_[twin.curve];
  if (twin.forward) return;
  const auto segments = static_cast<uint32_t>(graph_.curves()[curve].forward.size());
  for (CurvePoint& p : points_[curve])
    p = p.t > 0 ? CurvePoint{segments - 1 - p.segment, 1 - p.t} : CurvePoint{segments - p.segment, 0};
  // The first is the end now, which is none of the points; the start takes its place.
  std::reverse(points_[curve].begin() + 1, points_[curve].end());
  std::reverse(places_[curve].begin() + 1, places_[curve].end());
  points_[curve][0] = {0, 0};
  places_[curve][0] = surface_.mesh().positions[graph_.curves()[curve].start()];
}

absl::Status LoopBuilder::Divide(size_t curve, const GuidanceField& field, const Context& context) {
  if (graph_.curves()[curve].is_border) {
    points_[curve] = {{0, 0}};
    places_[curve] = {surface_.mesh().positions[graph_.curves()[curve].start()]};
    return absl::OkStatus();
  }
  if (twins_[curve].curve != kNoHalfEdge && points_[twins_[curve].curve].size() >= least_[curve]) {
    DivideLike(curve, twins_[curve]);
    return absl::OkStatus();
  }
  const Curve polyline = graph_.CurveOf(graph_.curves()[curve]);
  const double sagitta = graph_.curves()[curve].is_crease ? limits_.any : std::min(limits_.any, limits_.rim);
  const CurveLimits limits{least_[curve], sagitta, field.options().min_length};
  MESHFRONT_ASSIGN_OR_RETURN(points_[curve],
                             ResampleCurve(
                                 polyline, [&](const Vec3& x) { return field.At(x); }, context, limits));
  places_[curve].clear();
  for (const CurvePoint& p : points_[curve]) places_[curve].push_back(polyline.At(p));
  return absl::OkStatus();
}

// Two patches inside the same three edges would be the same triangle.
absl::Status LoopBuilder::SplitTwins(const GuidanceField& field, const Context& context) {
  std::set<std::vector<uint32_t>> triangles;
  for (const std::vector<Run>& runs : runs_) {
    std::vector<uint32_t> curves;
    size_t points = 0;
    for (const Run& run : runs) {
      curves.push_back(run.curve);
      points += points_[run.curve].size();
    }
    std::sort(curves.begin(), curves.end());
    if (points > 3 || triangles.insert(curves).second) continue;
    for (const uint32_t c : curves) {
      if (graph_.curves()[c].is_border) continue;
      least_[c] = points_[c].size() + 1;
      MESHFRONT_RETURN_IF_ERROR(Divide(c, field, context));
    }
  }
  return absl::OkStatus();
}

// Those on the border of a region first, in the order in which the surface lists them.
void LoopBuilder::NumberJoints() {
  uint32_t next = 0;
  for (const uint32_t v : surface_.border_vertices()) node_joints_.emplace(v, next++);
  const auto& curves = graph_.curves();
  for (size_t i = 0; i < curves.size(); ++i) {
    first_joint_.push_back(curves[i].is_crease ? next : kNoJoint);
    if (curves[i].is_crease) next += static_cast<uint32_t>(points_[i].size());
  }
  for (const FeatureCurve& c : curves) {
    if (c.closed) continue;
    for (const uint32_t node : {c.start(), c.end()}) {
      if (node_joints_.try_emplace(node, next).second) ++next;
    }
  }
}

// Point i of the curve, i counted in the direction of the run; the first is the node where it starts, if it has one.
LoopBuilder::Passed LoopBuilder::PassPoint(const Run& run, size_t i) const {
  const FeatureCurve& curve = graph_.curves()[run.curve];
  const std::vector<CurvePoint>& points = points_[run.curve];
  const size_t segments = curve.forward.size();
  const uint32_t first_joint = first_joint_[run.curve];
  const size_t at = run.forward ? i : (points.size() - i) % points.size();
  const CurvePoint& p = points[at];
  Passed passed;
  passed.on_crease = curve.is_crease || curve.is_border;
  if (run.forward)
    passed.place = PlaceOn(surface_, curve.forward[p.segment], p.t);
  else if (i == 0 && !curve.closed)
    passed.place = PlaceOn(surface_, curve.backward[segments - 1], 0);
  else if (p.t > 0)
    passed.place = PlaceOn(surface_, curve.backward[p.segment], 1 - p.t);
  else
    passed.place = PlaceOn(surface_, curve.backward[(p.segment + segments - 1) % segments], 0);
  if (i == 0 && !curve.closed) {
    passed.joint = node_joints_.at(run.forward ? curve.start() : curve.end());
  } else if (first_joint != kNoJoint) {
    passed.joint = first_joint + static_cast<uint32_t>(at);
    passed.place.position = places_[run.curve][at];  // in every bit as seen from the other side
  } else if (has_place_[run.curve]) {
    passed.place.position = places_[run.curve][at];  // … and from the sheet that it touches
  }
  return passed;
}

OrientedLoop LoopBuilder::LoopOf(const std::vector<Run>& runs) const {
  std::vector<Passed> passed;
  for (const Run& run : runs) {
    for (size_t i = 0; i < points_[run.curve].size(); ++i) passed.push_back(PassPoint(run, i));
  }
  OrientedLoop loop;
  const size_t n = passed.size();
  for (size_t i = n; i-- > 0;) {
    loop.points.push_back(passed[i].place);
    loop.joints.push_back(passed[i].joint);
    loop.creases.push_back(passed[(i + n - 1) % n].on_crease);
  }
  const auto is_joint = [](uint32_t j) { return j != kNoJoint; };
  if (std::none_of(loop.joints.begin(), loop.joints.end(), is_joint)) loop.joints.clear(), loop.creases.clear();
  return loop;
}

}  // namespace

absl::StatusOr<std::vector<SizingSample>> BoundarySizingSamples(
    const MeshSurface& surface, absl::FunctionRef<double(double max_curvature)> ideal_length, const Context& context) {
  std::vector<SizingSample> samples;
  const auto border = surface.border_vertices();
  for (const Rim& rim : RimsOf(surface)) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    if (std::all_of(rim.begin(), rim.end(), [&](uint32_t h) { return surface.IsBorder(h); })) continue;
    const Curve curve = CurveOf(surface, rim);
    // Creases are divided from node to node, whatever the length of the patch's rim.
    const bool on_crease =
        std::any_of(rim.begin(), rim.end(), [&](uint32_t h) { return surface.AcrossCrease(h) != kNoHalfEdge; });
    const double longest = on_crease ? std::numeric_limits<double>::infinity() : curve.length() / kMinEdgesPerLoop;
    const uint32_t component = surface.ComponentOf(FaceId(FaceOfHalfEdge(rim[0])));
    const double least = kLeastOfDiagonal * surface.whole_diagonals()[component];
    std::vector<double> smooth = CurveCurvatures(curve);
    for (double& value : smooth) value = std::min(longest, ideal_length(value));
    MESHFRONT_ASSIGN_OR_RETURN(const std::vector<double> chords, LongestChords(curve, smooth, ideal_length, context));
    for (size_t i = 0; i < curve.size(); ++i) {
      const uint32_t v = surface.OriginalOf(OriginOf(surface.mesh(), rim[i]));
      if (std::binary_search(border.begin(), border.end(), v)) continue;
      if (chords[i] > 0) samples.push_back({curve[i], std::max(chords[i], least)});
    }
  }
  return samples;
}

absl::StatusOr<std::vector<OrientedLoop>> BoundaryLoops(const MeshSurface& surface, const GuidanceField& field,
                                                        const SagittaLimits& limits, const Context& context) {
  LoopBuilder builder(surface, RimsOf(surface), limits);
  return builder.Build(field, context);
}

}  // namespace meshfront
