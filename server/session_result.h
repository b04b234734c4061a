// The result of a call that is to take the place of a session's mesh.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "core/mesh/mesh_sink.h"
#include "core/mesh/triangle_mesh.h"
#include "server/session_store.h"

namespace meshfront {

// Collects the mesh without its normals, as long as the store could keep it; beyond that it lets go of what it has and takes no more, so
// that the job goes on to its result. Memory: what the store keeps of a session at most, and a piece. Of one job, not thread-safe.
class SessionResult : public MeshSink {
 public:
  // The store outlives it.
  explicit SessionResult(const SessionStore& store) : store_(store) {}

  // Makes room for a mesh as large as this one, as the whole around a patch is, so that it need not grow there.
  void ReserveLike(const TriangleMesh& mesh);
  // Whether a result of about so many triangles could be kept: ResourceExhausted with SESSION_TOO_LARGE where it could not be by far
  // (half of them would be too many), as predictions go.
  absl::Status CheckPrediction(uint64_t triangles) const;
  // From here on it takes nothing, for the reason given.
  void Refuse(absl::Status why);
  // Always OK.
  absl::Status Append(const MeshPiece& piece) override;
  // OK, or why there is no mesh: ResourceExhausted with SESSION_TOO_LARGE.
  const absl::Status& status() const { return status_; }
  // The mesh, whose attributes have no channels yet; empty where status() is not OK.
  TriangleMesh Take() { return std::move(collected_.mesh); }

 private:
  const SessionStore& store_;
  CollectingSink collected_;
  absl::Status status_;
};

}  // namespace meshfront
