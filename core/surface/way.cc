// TraceWay: 1. the faces that a lies on; 2. of the sides of these that the plane passes through, the one most towards b; 3. over that
// to the next face and out of it over the other side that the plane passes through, until a face holds b. A corner in the plane counts
// as above it, so that the plane passes through no corner, and through none or two sides of a face.
#include "core/surface/way.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/container/inlined_vector.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr int Next(int corner) { return corner == 2 ? 0 : corner + 1; }
constexpr int Previous(int corner) { return corner == 0 ? 2 : corner - 1; }

struct Exit {
  uint32_t face = kNoHalfEdge;
  int side = 0;
};

class Section {
 public:
  Section(const FaceView& mesh, const Vec3& a, const Vec3& b, const Vec3& up)
      : mesh_(mesh), a_(a), b_(b), length_(Distance(a, b)), normal_(Cross(up, b - a)) {}

  bool Trace(uint32_t face_a, uint32_t face_b, std::vector<WayPiece>& way) const {
    const auto starts = FacesAround(face_a, a_);
    for (const uint32_t face : starts) {
      if (face != face_b && !IsOnSide(face, b_)) continue;
      way.push_back({face, a_, b_});
      return true;
    }
    Exit exit = FirstExit(starts);
    if (exit.face == kNoHalfEdge) return false;
    const size_t before = way.size();
    Vec3 from = a_;
    double walked = 0;
    while (walked <= kMaxWayPerDistance * length_ && way.size() - before < kMaxWayPieces) {
      const Vec3 to = Crossing(exit.face, exit.side);
      way.push_back({exit.face, from, to});
      walked += Distance(from, to);
      const uint32_t across = mesh_.opposite[3 * exit.face + exit.side];
      if (across == kNoHalfEdge) break;
      const uint32_t face = across / 3;
      from = to;
      if (face == face_b || IsOnSide(face, b_)) {
        way.push_back({face, from, b_});
        return true;
      }
      const int entry = static_cast<int>(across % 3);
      exit = {face, Crosses(face, Next(entry)) ? Next(entry) : Previous(entry)};
    }
    way.resize(before);
    return false;
  }

 private:
  double Height(uint32_t face, int corner) const { return Dot(normal_, mesh_.Corner(face, corner) - a_); }
  bool Crosses(uint32_t face, int side) const { return (Height(face, side) >= 0) != (Height(face, Next(side)) >= 0); }
  // From the end below, so that both faces of the side get the same bits.
  Vec3 Crossing(uint32_t face, int side) const {
    double low_height = Height(face, side), high_height = Height(face, Next(side));
    const Vec3 *low = &mesh_.Corner(face, side), *high = &mesh_.Corner(face, Next(side));
    if (low_height >= 0) std::swap(low_height, high_height), std::swap(low, high);
    return *low + low_height / (low_height - high_height) * (*high - *low);
  }
  bool IsOnSide(uint32_t face, int side, const Vec3& p) const {
    const Vec3 &from = mesh_.Corner(face, side), along = mesh_.Corner(face, Next(side)) - from;
    const double length2 = SquaredNorm(along);
    const double t = length2 > 0 ? std::clamp(Dot(p - from, along) / length2, 0.0, 1.0) : 0;
    return SquaredDistance(from + t * along, p) <= kOnSideOfWay * kOnSideOfWay * length_ * length_;
  }
  bool IsOnSide(uint32_t face, const Vec3& p) const {
    return IsOnSide(face, 0, p) || IsOnSide(face, 1, p) || IsOnSide(face, 2, p);
  }
  absl::InlinedVector<uint32_t, 8> FacesAround(uint32_t face, const Vec3& p) const {
    absl::InlinedVector<uint32_t, 8> faces = {face};
    for (size_t i = 0; i < faces.size() && faces.size() < kMaxFacesAtAPoint; ++i) {
      for (int side = 0; side < 3; ++side) {
        const uint32_t across = mesh_.opposite[3 * faces[i] + side];
        if (across == kNoHalfEdge || !IsOnSide(faces[i], side, p)) continue;
        if (std::find(faces.begin(), faces.end(), across / 3) == faces.end()) faces.push_back(across / 3);
      }
    }
    return faces;
  }
  Exit FirstExit(absl::Span<const uint32_t> starts) const {
    Exit exit;
    double best = 0;
    for (const uint32_t face : starts) {
      for (int side = 0; side < 3; ++side) {
        if (!Crosses(face, side)) continue;
        const Vec3 step = Crossing(face, side) - a_;
        const double size = Norm(step);
        if (size <= kOnSideOfWay * length_) continue;
        const double towards = Dot(step, b_ - a_) / size;
        if (towards > best) best = towards, exit = {face, side};
      }
    }
    return exit;
  }

  const FaceView& mesh_;
  const Vec3 a_, b_;
  const double length_;
  const Vec3 normal_;
};

// Strictly on different sides.
bool LieApart(double one, double other) { return (one < 0 && other > 0) || (one > 0 && other < 0); }

}  // namespace

bool TraceWay(const FaceView& mesh, const PlaceOnFace& a, const PlaceOnFace& b, const Vec3& up,
              std::vector<WayPiece>& way) {
  return Section(mesh, a.position, b.position, up).Trace(a.face, b.face, way);
}

bool WaysCross(absl::Span<const WayPiece> way, absl::Span<const WayPiece> other) {
  for (const WayPiece& p : way) {
    for (const WayPiece& q : other) {
      if (p.patch != q.patch) continue;
      const Vec3 n = Cross(p.to - p.from, q.to - q.from);
      const Vec3 across_p = Cross(n, p.to - p.from), across_q = Cross(n, q.to - q.from);
      if (LieApart(Dot(across_p, q.from - p.from), Dot(across_p, q.to - p.from)) &&
          LieApart(Dot(across_q, p.from - q.from), Dot(across_q, p.to - q.from))) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace meshfront
