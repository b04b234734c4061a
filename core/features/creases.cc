//   1. FaceNormals, of slivers without area from the face across their longest side, of hairs from what they lie between;
//   2. MarkSharp: edges that turn by more than the angle;
//   3. BridgeGaps: from where such a line ends, straight on over weaker edges until it meets a line again;
//   4. DropSpurs: lines that end inside a patch, from their ends back to where they meet others;
//   5. DropSpecks: small patches inside large ones, as noise makes them (specks.h);
//   6. AddFades: of the lines dropped in 4, long straight ones that start at a crease, on to where they fade out;
//   7. AddFaintLines: straight ones from crease to crease that stand out, however little they turn.
// Rejected: the threshold alone. A scan of 100,000 triangles has 12,000 edges beyond 40°, and 500 places that they close around.
#include "core/features/creases.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/base/status_macros.h"
#include "core/features/specks.h"
#include "core/features/tolerances.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

class CreaseFinder {
 public:
  CreaseFinder(const TriangleMesh& mesh, const FaceAdjacency& adjacency, double angle)
      : mesh_(mesh),
        adjacency_(adjacency),
        sharp_cosine_(std::cos(angle)),
        weak_cosine_(std::cos(kWeakCrease * angle)),
        faded_cosine_(std::cos(kFadedCrease * angle)),
        diagonal_(BoundingBox(mesh, adjacency).Diagonal()),
        crease_(3 * mesh.triangles.size(), false),
        degree_(mesh.positions.size(), 0) {}

  absl::StatusOr<std::vector<bool>> Run(const Context& context) {
    FindFaceNormals();
    SmoothHairs();
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    if (!MarkSharp()) return std::move(crease_);
    BridgeGaps();
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    FindFades();
    DropSpurs();
    DropSpecks();
    AddFades();
    AddFaintLines();
    return std::move(crease_);
  }

 private:
  uint32_t HalfEdges() const { return static_cast<uint32_t>(crease_.size()); }
  uint32_t Origin(uint32_t h) const { return OriginOf(mesh_, h).index(); }
  uint32_t Target(uint32_t h) const { return TargetOf(mesh_, h).index(); }
  const Vec3& Place(uint32_t v) const { return mesh_.positions[v]; }

  void FindFaceNormals();
  void SmoothHairs();
  static bool IsThin(double area2, double longest2) { return area2 < kHairAspect * kHairAspect * longest2 * longest2; }
  bool IsHair(uint32_t f, double highest) const;
  uint32_t LongerBeside(uint32_t h) const;
  uint32_t BesideHair(uint32_t h, double highest) const;
  bool MarkSharp();
  void BridgeGaps();
  bool Bridge(uint32_t from, std::vector<uint32_t>& way) const;
  uint32_t StraightOn(uint32_t at, const Vec3& direction, double least_cosine) const;
  std::vector<uint32_t> FadeAt(uint32_t end, double least_length) const;
  void FindFades();
  int CreasesAt(uint32_t v) const;
  void AddFades();
  bool StandsOut(uint32_t h, uint32_t next) const;
  bool IsFaintLine(uint32_t h, double least_length, std::vector<uint32_t>& line) const;
  void AddFaintLines();
  void DropSpurs();
  void DropSpecks();

  double CosineAt(uint32_t h) const { return Dot(normals_[h / 3], normals_[adjacency_.OppositeOf(h) / 3]); }
  void Set(uint32_t h, bool value) {
    const uint32_t other = adjacency_.OppositeOf(h);
    if (crease_[h] == value) return;
    crease_[h] = crease_[other] = value;
    for (const uint32_t v : {Origin(h), Target(h)}) degree_[v] += value ? 1 : -1;
  }
  // Calls visit(h) for the half-edges that leave v and have faces on both sides.
  template <class Visit>
  void VisitInner(uint32_t v, Visit visit) const {
    VisitOutgoing(adjacency_, v, [&](uint32_t h) {
      if (adjacency_.OppositeOf(h) != kNoHalfEdge) visit(h);
    });
  }

  const TriangleMesh& mesh_;
  const FaceAdjacency& adjacency_;
  const double sharp_cosine_, weak_cosine_, faded_cosine_;
  const double diagonal_;  // of the mesh's box
  std::vector<Vec3> normals_;
  std::vector<uint32_t> thin_;  // faces: hairs are among them
  std::vector<bool> crease_;
  std::vector<int> degree_;                   // creases at each vertex; on the rim two more
  std::vector<std::vector<uint32_t>> fades_;  // half-edges, from where a line ends back to where it starts
};

void CreaseFinder::FindFaceNormals() {
  const size_t n = mesh_.triangles.size();
  normals_.resize(n);
  std::vector<uint32_t> slivers;
  for (uint32_t f = 0; f < n; ++f) {
    const Triangle& t = mesh_.triangles[f];
    const Vec3 &a = mesh_.PositionAt(t[0]), &b = mesh_.PositionAt(t[1]), &c = mesh_.PositionAt(t[2]);
    const Vec3 area = AreaVector(a, b, c);
    const double norm = Norm(area), longest2 = SquaredLongestSide(a, b, c);
    normals_[f] = norm > 0 ? area / norm : Vec3{};
    if (norm < kSliverHeight * longest2) slivers.push_back(f);
    if (IsThin(SquaredNorm(area), longest2)) thin_.push_back(f);
  }
  for (const uint32_t f : slivers) {
    const uint32_t across = adjacency_.OppositeOf(LongestSide(mesh_, f));
    if (across != kNoHalfEdge) normals_[f] = normals_[across / 3];
  }
}

bool CreaseFinder::IsHair(uint32_t f, double highest) const {
  const Triangle& t = mesh_.triangles[f];
  const Vec3 &a = mesh_.PositionAt(t[0]), &b = mesh_.PositionAt(t[1]), &c = mesh_.PositionAt(t[2]);
  const double longest2 = SquaredLongestSide(a, b, c);
  const double area2 = SquaredNorm(AreaVector(a, b, c));  // aspect² · longest⁴ = height² · longest²
  return IsThin(area2, longest2) && area2 < highest * highest * longest2;
}

// Of the two other sides of its face.
uint32_t CreaseFinder::LongerBeside(uint32_t h) const {
  const uint32_t next = NextHalfEdge(h), previous = PreviousHalfEdge(h);
  return SquaredLength(mesh_, previous) > SquaredLength(mesh_, next) ? previous : next;
}

// The face across side h of a hair; where that is a hair itself, the one across its longer other side, and so on.
uint32_t CreaseFinder::BesideHair(uint32_t h, double highest) const {
  for (int step = 0; step < kMaxHairs; ++step) {
    h = adjacency_.OppositeOf(h);
    if (h == kNoHalfEdge || !IsHair(h / 3, highest)) break;
    h = LongerBeside(h);
  }
  return h == kNoHalfEdge || IsHair(h / 3, highest) ? kNoHalfEdge : h / 3;
}

//      ______________
//     /      a       \       Where a and b agree, what lies between them is no crease, whatever the needle's own normal.
//     ====== hair ====
//     \______ b ______/
void CreaseFinder::SmoothHairs() {
  const double highest = kHairOfDiagonal * diagonal_;
  std::vector<std::pair<uint32_t, Vec3>> smooth;
  for (const uint32_t f : thin_) {
    if (!IsHair(f, highest)) continue;
    const uint32_t h = LongestSide(mesh_, f);
    const uint32_t a = BesideHair(h, highest), b = BesideHair(LongerBeside(h), highest);
    if (a == kNoHalfEdge || b == kNoHalfEdge || Dot(normals_[a], normals_[b]) < weak_cosine_) continue;
    smooth.emplace_back(f, Normalized(normals_[a] + normals_[b]));
  }
  for (const auto& [f, normal] : smooth) normals_[f] = normal;
}

bool CreaseFinder::MarkSharp() {
  bool any = false;
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
    for (uint32_t i = 0; i < 3; ++i) {
      const uint32_t h = 3 * f + i, other = adjacency_.opposite[f][i];
      if (other == kNoHalfEdge) {
        ++degree_[Origin(h)], ++degree_[Target(h)];
      } else if (other > h && Dot(normals_[f], normals_[other / 3]) < sharp_cosine_) {
        Set(h, true);
        any = true;
      }
    }
  }
  return any;
}

// The sharpest edge from here that goes straight on and turns by more than this; kNoHalfEdge when there is none.
uint32_t CreaseFinder::StraightOn(uint32_t at, const Vec3& direction, double least_cosine) const {
  uint32_t best = kNoHalfEdge;
  double best_cosine = least_cosine;
  VisitInner(at, [&](uint32_t h) {
    const Vec3 along = Normalized(Place(Target(h)) - Place(at));
    if (crease_[h] || Dot(along, direction) < kBridgeStraightness || CosineAt(h) >= best_cosine) return;
    best = h, best_cosine = CosineAt(h);
  });
  return best;
}

// The way from the end of a line, along the sharpest edges that go straight on, to the next line; false when there is none near by.
bool CreaseFinder::Bridge(uint32_t from, std::vector<uint32_t>& way) const {
  way.clear();
  uint32_t at = from;
  Vec3 direction;
  VisitInner(from, [&](uint32_t h) {
    if (crease_[h]) direction = Normalized(Place(from) - Place(Target(h)));
  });
  for (int step = 0; step < kMaxBridge; ++step) {
    const uint32_t best = StraightOn(at, direction, weak_cosine_);
    if (best == kNoHalfEdge) return false;
    way.push_back(best);
    direction = Normalized(Place(Target(best)) - Place(at));
    at = Target(best);
    if (at == from) return false;
    if (degree_[at] > 0) return true;
  }
  return false;
}

void CreaseFinder::BridgeGaps() {
  std::vector<uint32_t> way;
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    if (degree_[v] != 1 || !Bridge(v, way)) continue;
    for (const uint32_t h : way) Set(h, true);
  }
}

// The line that ends here, back to where it starts, if its last edges come a long way straight: noise makes no such lines.
std::vector<uint32_t> CreaseFinder::FadeAt(uint32_t end, double least_length) const {
  std::vector<uint32_t> line;
  double length = 0, cosines = 0;
  Vec3 direction;
  bool is_long = false;
  for (uint32_t at = end; line.empty() || (degree_[at] == 2 && at != end);) {
    uint32_t back = kNoHalfEdge;
    VisitInner(at, [&](uint32_t h) {
      if (crease_[h] && (line.empty() || h != adjacency_.OppositeOf(line.back()))) back = h;
    });
    if (back == kNoHalfEdge) return {};
    const Vec3 edge = Place(Target(back)) - Place(at);
    if (!line.empty()) cosines += Dot(Normalized(edge), direction);
    direction = Normalized(edge);
    length += Norm(edge);
    line.push_back(back);
    at = Target(back);
    if (is_long || line.size() < kFadeEdges || length < least_length) continue;
    is_long = true;
    if (cosines < kFadeStraightness * static_cast<double>(line.size() - 1)) return {};
  }
  return is_long ? line : std::vector<uint32_t>();
}

void CreaseFinder::FindFades() {
  const double least_length = kFadeOfDiagonal * diagonal_;
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    if (degree_[v] != 1) continue;
    std::vector<uint32_t> line = FadeAt(v, least_length);
    if (!line.empty()) fades_.push_back(std::move(line));
  }
}

// Rims are none: scans have long folds that start there.
int CreaseFinder::CreasesAt(uint32_t v) const {
  int creases = 0;
  VisitInner(v, [&](uint32_t h) { creases += crease_[h]; });
  return creases;
}

void CreaseFinder::AddFades() {
  for (const std::vector<uint32_t>& line : fades_) {
    if (CreasesAt(Target(line.back())) < 2 || crease_[line.front()]) continue;
    uint32_t at = Origin(line.front());
    Vec3 direction = Normalized(Place(at) - Place(Target(line.front())));
    for (const uint32_t h : line) Set(h, true);
    while (degree_[at] == 1) {
      const uint32_t next = StraightOn(at, direction, faded_cosine_);
      if (next == kNoHalfEdge) break;
      direction = Normalized(Place(Target(next)) - Place(at));
      Set(next, true);
      at = Target(next);
    }
  }
}

// Of a line that comes in at h and goes out at `next`, through a vertex where nothing else turns: what ends at its other two vertices
// aside, all edges of the faces around turn by half as much at most.
bool CreaseFinder::StandsOut(uint32_t h, uint32_t next) const {
  const double flat_cosine = std::cos(kFlatBesideFaint * std::acos(std::clamp(CosineAt(h), -1.0, 1.0)));
  const uint32_t from = Origin(h), to = Target(next);
  bool stands_out = true;
  VisitInner(Target(h), [&](uint32_t spoke) {
    const uint32_t rim = NextHalfEdge(spoke);
    const auto is_at = [&](uint32_t v) { return Origin(rim) == v || Target(rim) == v; };
    if (Target(spoke) != from && Target(spoke) != to && CosineAt(spoke) < flat_cosine) stands_out = false;
    if (!is_at(from) && !is_at(to) && (adjacency_.OppositeOf(rim) == kNoHalfEdge || CosineAt(rim) < flat_cosine))
      stands_out = false;
  });
  return stands_out;
}

bool CreaseFinder::IsFaintLine(uint32_t h, double least_length, std::vector<uint32_t>& line) const {
  line.clear();
  const uint32_t start = Origin(h);
  for (double length = 0;;) {
    line.push_back(h);
    const Vec3 edge = Place(Target(h)) - Place(Origin(h));
    length += Norm(edge);
    const uint32_t at = Target(h);
    if (at == start) return false;
    if (degree_[at] > 0) return degree_[at] >= 2 && line.size() >= kFaintEdges && length >= least_length;
    const uint32_t next = StraightOn(at, Normalized(edge), faded_cosine_);
    if (next == kNoHalfEdge || !StandsOut(h, next)) return false;
    h = next;
  }
}

void CreaseFinder::AddFaintLines() {
  const double least_length = kFaintOfDiagonal * diagonal_;
  std::vector<uint32_t> line, faint;
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    if (degree_[v] < 2) continue;
    VisitInner(v, [&](uint32_t h) {
      if (crease_[h] || CosineAt(h) >= faded_cosine_ || !IsFaintLine(h, least_length, line)) return;
      faint.insert(faint.end(), line.begin(), line.end());
    });
  }
  for (const uint32_t h : faint) Set(h, true);
}

void CreaseFinder::DropSpurs() {
  std::vector<uint32_t> ends;
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    if (degree_[v] == 1) ends.push_back(v);
  }
  while (!ends.empty()) {
    const uint32_t v = ends.back();
    ends.pop_back();
    uint32_t last = kNoHalfEdge;
    VisitInner(v, [&](uint32_t h) {
      if (crease_[h]) last = h;
    });
    if (degree_[v] != 1 || last == kNoHalfEdge) continue;
    Set(last, false);
    if (degree_[Target(last)] == 1) ends.push_back(Target(last));
  }
}

// First those that stand alone, then what else hangs together.
void CreaseFinder::DropSpecks() {
  for (const uint32_t most_faces : {kSpeckFaces, kMaxSpeckFaces}) {
    const std::vector<bool> specks = FindSpecks(mesh_, adjacency_, crease_, most_faces);
    for (uint32_t h = 0; h < HalfEdges(); ++h) {
      if (specks[h]) Set(h, false);
    }
    DropSpurs();
  }
}

}  // namespace

absl::StatusOr<std::vector<bool>> FindCreases(const TriangleMesh& mesh, const FaceAdjacency& adjacency, double angle,
                                              const Context& context) {
  return CreaseFinder(mesh, adjacency, angle).Run(context);
}

}  // namespace meshfront
