// Algorithm: 1. Project the vertices; 2. Rasterise each face into a depth buffer at twice the resolution (FillFace), darkening
// samples near one of its edges (EdgeDarkness); 3. Resolve the samples into the picture. Lines drawn apart from faces were
// rejected: they fight with the faces for depth, while a distance to the edge is exact and antialiased at no cost.
#include "client/cli/picture/wireframe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr int kSamples = 2;  // per pixel and direction
constexpr Color kWellShaped{158, 184, 208}, kSliver{236, 120, 62}, kBehind{176, 70, 84}, kWire{24, 30, 44},
    kDot{70, 100, 140};
// Radius ratios at which a face is drawn as a sliver, and as well shaped.
constexpr double kSliverRatio = 0.25, kWellShapedRatio = 0.8;
constexpr double kHalfLine = 0.45, kLineBlur = 0.45;  // pixels
constexpr double kFaintestEdge = 1.2,
                 kStrongestEdge = 7.0;  // mean edge in pixels: below and above it lines grow no fainter/stronger
constexpr double kFaintestLine = 0.12, kStrongestLine = 0.85;
constexpr double kAmbient = 0.42, kDiffuse = 0.62;

double SmoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Color Blend(Color a, Color b, double t) {
  auto mix = [t](uint8_t from, uint8_t to) { return static_cast<uint8_t>(std::lround(from + t * (to - from))); };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

Color Lit(Color base, double light) {
  auto scale = [light](uint8_t c) { return static_cast<uint8_t>(std::clamp(std::lround(c * light), 0L, 255L)); };
  return {scale(base.red), scale(base.green), scale(base.blue)};
}

class Rasteriser {
 public:
  Rasteriser(const TriangleMesh& mesh, const View& view, const PixelRect& rect)
      : mesh_(mesh),
        view_(view),
        rect_(rect),
        width_(rect.width * kSamples),
        height_(rect.height * kSamples),
        depth_(static_cast<size_t>(width_) * height_, -std::numeric_limits<float>::infinity()),
        color_(depth_.size()) {
    const double extent = std::min(width_, height_);
    scale_ = extent / (2 * view.half_extent);
    key_light_ = Normalized(-0.45 * view.right + 0.55 * view.up + 0.75 * view.toward);
  }

  void DrawFaces() {
    line_strength_ = LineStrength();
    for (const Triangle& t : mesh_.triangles) DrawFace(t);
  }

  void DrawDots() {
    for (const Vec3& p : mesh_.positions) {
      if (!IsFinite(p)) continue;
      const Vec3 s = Project(p);
      if (!ReachesIntoPicture(s)) continue;
      for (int dy = 0; dy < kSamples; ++dy) {
        for (int dx = 0; dx < kSamples; ++dx) Put(static_cast<int>(s.x) + dx, static_cast<int>(s.y) + dy, s.z, kDot);
      }
    }
  }

  // The mean of the samples of each pixel, over what is in the picture.
  void Resolve(Canvas& canvas) const {
    for (int y = 0; y < rect_.height; ++y) {
      for (int x = 0; x < rect_.width; ++x) ResolvePixel(x, y, canvas);
    }
  }

 private:
  Vec3 Project(const Vec3& p) const {
    const Vec3 d = p - view_.center;
    return {0.5 * width_ + scale_ * Dot(d, view_.right), 0.5 * height_ - scale_ * Dot(d, view_.up),
            scale_ * Dot(d, view_.toward)};
  }

  // Of a dot, whose place may be beyond any int, or none at all where infinities have met.
  bool ReachesIntoPicture(const Vec3& s) const {
    return s.x > -kSamples && s.x < width_ && s.y > -kSamples && s.y < height_;
  }

  bool IsDrawable(const Triangle& t) const {
    for (const VertexId v : t) {
      if (v.index() >= mesh_.positions.size() || !IsFinite(mesh_.PositionAt(v))) return false;
    }
    return true;
  }

  // Dense meshes get faint lines, else they would be black.
  double LineStrength() const {
    double sum = 0;
    size_t count = 0;
    for (const Triangle& t : mesh_.triangles) {
      if (!IsDrawable(t)) continue;
      sum += Distance(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1])), ++count;
    }
    const double mean_pixels = count == 0 ? 0 : sum / count * scale_ / kSamples;
    return kFaintestLine + (kStrongestLine - kFaintestLine) * SmoothStep(kFaintestEdge, kStrongestEdge, mean_pixels);
  }

  Color FaceColor(const std::array<Vec3, 3>& p, bool behind) const {
    Vec3 normal = Normalized(AreaVector(p[0], p[1], p[2]));
    if (behind) normal = -normal;
    const double light = kAmbient + kDiffuse * std::max(0.0, Dot(normal, key_light_));
    const double well = SmoothStep(kSliverRatio, kWellShapedRatio, RadiusRatio(p[0], p[1], p[2]));
    return Lit(behind ? kBehind : Blend(kSliver, kWellShaped, well), light);
  }

  void DrawFace(const Triangle& t) {
    if (!IsDrawable(t)) return;
    const std::array<Vec3, 3> p = {mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2])};
    const std::array<Vec3, 3> s = {Project(p[0]), Project(p[1]), Project(p[2])};
    // The picture's y points down, so that a face seen from its front runs clockwise there.
    const double area = (s[1].x - s[0].x) * (s[2].y - s[0].y) - (s[1].y - s[0].y) * (s[2].x - s[0].x);
    if (!(std::abs(area) > 1e-9)) return;
    FillFace(s, area, FaceColor(p, area > 0));
  }

  void FillFace(const std::array<Vec3, 3>& s, double area, Color color) {
    const auto [min_x, max_x] = std::minmax({s[0].x, s[1].x, s[2].x});
    const auto [min_y, max_y] = std::minmax({s[0].y, s[1].y, s[2].y});
    const int x0 = static_cast<int>(std::clamp(std::floor(min_x), 0.0, width_ - 1.0));
    const int x1 = static_cast<int>(std::clamp(std::ceil(max_x), 0.0, width_ - 1.0));
    const int y0 = static_cast<int>(std::clamp(std::floor(min_y), 0.0, height_ - 1.0));
    const int y1 = static_cast<int>(std::clamp(std::ceil(max_y), 0.0, height_ - 1.0));
    std::array<double, 3> altitude;  // pixels from each side to its opposite corner
    for (int i = 0; i < 3; ++i) {
      const Vec3 side = s[(i + 2) % 3] - s[(i + 1) % 3];
      altitude[i] = std::abs(area) / std::hypot(side.x, side.y) / kSamples;
    }
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) FillSample(x, y, s, area, altitude, color);
    }
  }

  void FillSample(int x, int y, const std::array<Vec3, 3>& s, double area, const std::array<double, 3>& altitude,
                  Color color) {
    const double px = x + 0.5, py = y + 0.5;
    const double w0 = ((s[1].x - px) * (s[2].y - py) - (s[1].y - py) * (s[2].x - px)) / area;
    const double w1 = ((s[2].x - px) * (s[0].y - py) - (s[2].y - py) * (s[0].x - px)) / area;
    const double w2 = 1 - w0 - w1;
    if (w0 < 0 || w1 < 0 || w2 < 0) return;
    const double to_edge = std::min({w0 * altitude[0], w1 * altitude[1], w2 * altitude[2]});
    const double darkness = line_strength_ * (1 - SmoothStep(kHalfLine - kLineBlur, kHalfLine + kLineBlur, to_edge));
    Put(x, y, w0 * s[0].z + w1 * s[1].z + w2 * s[2].z, Blend(color, kWire, darkness));
  }

  void Put(int x, int y, double depth, Color color) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    const size_t i = static_cast<size_t>(y) * width_ + x;
    if (static_cast<float>(depth) <= depth_[i]) return;
    depth_[i] = static_cast<float>(depth);
    color_[i] = color;
  }

  void ResolvePixel(int x, int y, Canvas& canvas) const {
    const int px = rect_.left + x, py = rect_.top + y;
    if (px < 0 || py < 0 || px >= canvas.width() || py >= canvas.height()) return;
    const Color background = canvas.At(px, py);
    int red = 0, green = 0, blue = 0;
    for (int dy = 0; dy < kSamples; ++dy) {
      for (int dx = 0; dx < kSamples; ++dx) {
        const size_t i = static_cast<size_t>(y * kSamples + dy) * width_ + x * kSamples + dx;
        const Color c = std::isinf(depth_[i]) ? background : color_[i];
        red += c.red, green += c.green, blue += c.blue;
      }
    }
    constexpr int count = kSamples * kSamples;
    canvas.Set(
        px, py,
        {static_cast<uint8_t>(red / count), static_cast<uint8_t>(green / count), static_cast<uint8_t>(blue / count)});
  }

  const TriangleMesh& mesh_;
  const View& view_;
  const PixelRect rect_;
  const int width_, height_;  // in samples
  double scale_ = 1;          // samples per unit of length
  double line_strength_ = 1;
  Vec3 key_light_;
  std::vector<float> depth_;
  std::vector<Color> color_;
};

}  // namespace

Color WellShapedColor() { return kWellShaped; }
Color SliverColor() { return kSliver; }

void DrawWireframe(const TriangleMesh& mesh, const View& view, const PixelRect& rect, Canvas& canvas) {
  Rasteriser rasteriser(mesh, view, rect);
  if (mesh.IsPointSet())
    rasteriser.DrawDots();
  else
    rasteriser.DrawFaces();
  rasteriser.Resolve(canvas);
}

}  // namespace meshfront
