#include "server/session_result.h"

#include <utility>

#include "core/prepared_input.h"

namespace meshfront {
namespace {

// Predictions are a few percent off, seldom more; nothing that fits is refused.
constexpr uint64_t kSurelyTooMany = 2;

}  // namespace

absl::Status SessionResult::CheckPrediction(uint64_t triangles) const {
  const uint64_t surely = triangles / kSurelyTooMany;
  return store_.CheckSize(PreparedInput::LeastBytes({.vertices = surely / 2, .triangles = surely}));
}

void SessionResult::ReserveLike(const TriangleMesh& mesh) {
  collected_.mesh.positions.reserve(mesh.positions.size());
  collected_.mesh.triangles.reserve(mesh.triangles.size());
}

void SessionResult::Refuse(absl::Status why) {
  status_ = std::move(why);
  collected_ = {};
}

absl::Status SessionResult::Append(const MeshPiece& piece) {
  if (!status_.ok()) return absl::OkStatus();
  MeshPiece wanted = piece;
  wanted.finalised = {};
  absl::Status appended = collected_.Append(wanted);
  collected_.mesh.normals.clear();
  const absl::Status fits = store_.CheckSize(PreparedInput::LeastBytes(PreparedInput::SizeOf(collected_.mesh)));
  if (!fits.ok()) Refuse(fits);
  return appended;
}

}  // namespace meshfront
