#include "core/mesh/repair_outside.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/geometry/box.h"

namespace meshfront {
namespace {

constexpr double kSmallestVolumeRatio = 1e-12;  // of the box diagonal cubed: beyond rounding
constexpr uint64_t kMostWork = 400'000'000;     // pairs of boxes, about 2 ns each
constexpr uint64_t kWorkPerFace = 20;           // of a winding number, in the same unit

struct Component {
  uint32_t first_face = 0;
  uint64_t faces = 0;
  bool closed = true;
  double volume = 0;  // times six
  Box3 box;
  bool reversed = false;

  bool IsSolid(int sign) const {
    const double diagonal = box.Diagonal();
    return closed && sign * volume > kSmallestVolumeRatio * diagonal * diagonal * diagonal;
  }
};

bool Encloses(const Box3& outer, const Box3& inner) {
  for (int i = 0; i < 3; ++i) {
    if (inner.min[i] < outer.min[i] || inner.max[i] > outer.max[i]) return false;
  }
  return true;
}

class Nesting {
 public:
  Nesting(const TriangleMesh& mesh, const FaceAdjacency& adjacency) : mesh_(mesh), labels_(LabelComponents(adjacency)) {
    components_.resize(labels_.count);
    for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
      Component& c = components_[labels_.label[f]];
      if (c.faces++ == 0) c.first_face = f;
      const Vec3 origin = Corner(c.first_face, 0);
      c.volume += Dot(Corner(f, 0) - origin, Cross(Corner(f, 1) - origin, Corner(f, 2) - origin));
      for (const uint32_t across : adjacency.opposite[f]) c.closed &= across != kNoHalfEdge;
    }
  }

  uint64_t FindReversed() {
    const auto faces_inwards = [](const Component& c) { return c.closed && c.volume < 0; };
    if (std::none_of(components_.begin(), components_.end(), faces_inwards)) return 0;
    MeasureBoxes();
    if (std::none_of(components_.begin(), components_.end(), [](const Component& c) { return c.IsSolid(-1); }))
      return 0;
    ListFaces();
    std::vector<uint32_t> roots;
    for (uint32_t c = 0; c < components_.size(); ++c) {
      if (components_[c].IsSolid(-1) && DepthOf(c) == 0) components_[c].reversed = true, roots.push_back(c);
    }
    for (uint32_t c = 0; c < components_.size() && !roots.empty(); ++c) {
      if (!components_[c].reversed && IsInsideAny(c, roots)) ReverseUnlessAsDeep(c);
    }
    uint64_t count = 0;
    for (const Component& c : components_) count += c.reversed;
    return count;
  }

  uint64_t component_count() const { return components_.size(); }
  bool IsReversed(uint32_t f) const { return components_[labels_.label[f]].reversed; }

 private:
  const Vec3& Corner(uint32_t f, int i) const { return mesh_.PositionAt(mesh_.triangles[f][i]); }

  void MeasureBoxes() {
    for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
      for (int i = 0; i < 3; ++i) components_[labels_.label[f]].box.Extend(Corner(f, i));
    }
  }

  void ListFaces() {
    faces_.resize(components_.size());
    for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) faces_[labels_.label[f]].push_back(f);
  }

  // Within a nest that is inside out as a whole: outwards at even depths, inwards at odd ones.
  void ReverseUnlessAsDeep(uint32_t c) {
    const int depth = DepthOf(c);
    if (depth > 0 && components_[c].IsSolid(depth % 2 == 0 ? -1 : 1)) components_[c].reversed = true;
  }

  // How many closed components the component lies in; −1 when that is too much work.
  int DepthOf(uint32_t c) {
    int depth = 0;
    for (uint32_t other = 0; other < components_.size(); ++other) {
      const int inside = IsInside(c, other);
      if (inside < 0) return -1;
      depth += inside;
    }
    return depth;
  }
  bool IsInsideAny(uint32_t c, const std::vector<uint32_t>& outer) {
    for (const uint32_t o : outer) {
      if (IsInside(c, o) > 0) return true;
    }
    return false;
  }

  int IsInside(uint32_t inner, uint32_t outer) {
    const Component &in = components_[inner], &out = components_[outer];
    if (++work_ > kMostWork) return -1;
    if (inner == outer || !out.closed || !Encloses(out.box, in.box)) return 0;
    work_ += kWorkPerFace * out.faces;
    if (work_ > kMostWork) return -1;
    return std::abs(WindingNumber(Corner(in.first_face, 0), outer)) > 0.5;
  }

  // Sum of the solid angles of the faces as seen from p (van Oosterom and Strackee), over 4π: an integer inside or
  // outside.
  double WindingNumber(const Vec3& p, uint32_t component) const {
    double sum = 0;
    for (const uint32_t f : faces_[component]) {
      const Vec3 a = Corner(f, 0) - p, b = Corner(f, 1) - p, c = Corner(f, 2) - p;
      const double x = Norm(a), y = Norm(b), z = Norm(c);
      sum += std::atan2(Dot(a, Cross(b, c)), x * y * z + Dot(a, b) * z + Dot(b, c) * x + Dot(c, a) * y);
    }
    return sum / (2 * std::numbers::pi);
  }

  const TriangleMesh& mesh_;
  FaceComponents labels_;
  std::vector<Component> components_;
  std::vector<std::vector<uint32_t>> faces_;
  uint64_t work_ = 0;
};

}  // namespace

OutwardTurns TurnOutwards(TriangleMesh& mesh, const FaceAdjacency& adjacency) {
  Nesting nesting(mesh, adjacency);
  const uint64_t reversed = nesting.FindReversed();
  for (uint32_t f = 0; reversed > 0 && f < mesh.triangles.size(); ++f) {
    if (nesting.IsReversed(f)) ReverseFace(mesh, f);
  }
  return {reversed, nesting.component_count()};
}

}  // namespace meshfront
