#include "core/mesh/holding_sink.h"

#include <utility>

#include "core/base/status_macros.h"

namespace meshfront {

HeldPiece::HeldPiece(const MeshPiece& piece)
    : vertices(piece.vertices.begin(), piece.vertices.end()),
      triangles(piece.triangles.begin(), piece.triangles.end()),
      finalised(piece.finalised.begin(), piece.finalised.end()),
      kinds(piece.kinds.begin(), piece.kinds.end()),
      wedges(piece.wedges.begin(), piece.wedges.end()),
      corners(piece.corners.begin(), piece.corners.end()),
      faces(piece.faces.begin(), piece.faces.end()),
      open_front_edges(piece.open_front_edges) {}

absl::Status HoldingSink::Append(const MeshPiece& piece) {
  if (!is_passing_ && triangles_ + piece.triangles.size() <= limit_) {
    triangles_ += piece.triangles.size();
    pieces_.emplace_back(piece);
    return absl::OkStatus();
  }
  MESHFRONT_RETURN_IF_ERROR(Release());
  return next_.Append(piece);
}

std::vector<HeldPiece> HoldingSink::Take() {
  triangles_ = 0;
  return std::exchange(pieces_, {});
}

absl::Status HoldingSink::Release() {
  is_passing_ = true;
  for (const HeldPiece& piece : Take()) MESHFRONT_RETURN_IF_ERROR(next_.Append(piece.View()));
  return absl::OkStatus();
}

}  // namespace meshfront
