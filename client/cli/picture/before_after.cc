#include "client/cli/picture/before_after.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/wireframe.h"
#include "client/cli/text.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr Color kPaper{250, 250, 248}, kRule{205, 208, 212}, kInk{38, 44, 56}, kGrey{120, 126, 136};
constexpr int kMargin = 24;

std::string Percent(double share) {
  const int64_t tenths = static_cast<int64_t>(share * 1000 + 0.5);
  return absl::StrCat(tenths / 10, ".", tenths % 10, "%");
}

// The share of faces with a radius ratio below one half.
double ShareOfPoorFaces(const TriangleMesh& mesh) {
  size_t poor = 0;
  for (const Triangle& t : mesh.triangles) {
    bool known = true;
    for (const VertexId v : t) known &= v.index() < mesh.positions.size();
    if (known && RadiusRatio(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])) < 0.5) ++poor;
  }
  return mesh.triangles.empty() ? 0 : static_cast<double>(poor) / mesh.triangles.size();
}

}  // namespace

BeforeAfterPicture::BeforeAfterPicture() : canvas_(kWidth, kHeight, kPaper) {
  canvas_.FillRect({kWidth / 2, kMargin, 1, kHeight - 2 * kMargin}, kRule);
}

void BeforeAfterPicture::DrawBefore(const TriangleMesh& mesh) {
  view_ = ChooseView(mesh);
  DrawHalf(mesh, "before", 0);
}

void BeforeAfterPicture::DrawAfter(const TriangleMesh& mesh) { DrawHalf(mesh, "after", kWidth / 2); }

void BeforeAfterPicture::DrawHalf(const TriangleMesh& mesh, const std::string& title, int left) {
  const PixelRect panel{left + kMargin / 2, kCaption + kMargin / 2, kWidth / 2 - kMargin, kHeight - kCaption - kMargin};
  DrawWireframe(mesh, view_, panel, canvas_);
  canvas_.DrawText(left + kMargin, kMargin, 3, title, kInk);
  const int right = left + kWidth / 2 - kMargin;
  const std::string count = mesh.IsPointSet() ? absl::StrCat(WithThousands(mesh.positions.size()), " points")
                                              : absl::StrCat(WithThousands(mesh.triangles.size()), " triangles");
  canvas_.DrawText(right - Canvas::TextWidth(count, 2), kMargin - 2, 2, count, kInk);
  if (mesh.IsPointSet()) return;
  const std::string poor = absl::StrCat(Percent(ShareOfPoorFaces(mesh)), " with 2r/R < 0.5");
  const int x = right - Canvas::TextWidth(poor, 2);
  canvas_.DrawText(x, kMargin + 20, 2, poor, kGrey);
  canvas_.FillRect({x - 24, kMargin + 20, 14, 14}, SliverColor());
}

}  // namespace meshfront
