// The picture of `--picture`: the input on the left, the output on the right, from the same direction.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "client/cli/picture/canvas.h"
#include "client/cli/picture/view.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Draws one half at a time, so that the two meshes need not be in memory together:
//   BeforeAfterPicture picture;
//   picture.DrawBefore(input);    // chooses the view
//   picture.DrawAfter(output);
//   std::string png; picture.canvas().EncodePng(&png);
class BeforeAfterPicture {
 public:
  static constexpr int kWidth = 1600, kHeight = 860, kCaption = 60;  // pixels

  BeforeAfterPicture();
  void DrawBefore(const TriangleMesh& mesh);
  void DrawAfter(const TriangleMesh& mesh);
  const Canvas& canvas() const { return canvas_; }

 private:
  void DrawHalf(const TriangleMesh& mesh, const std::string& title, int left);

  Canvas canvas_;
  View view_;
};

}  // namespace meshfront
