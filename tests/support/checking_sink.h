// A sink that holds the engine to what mesh_sink.h promises, and keeps the mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/mesh/mesh_sink.h"

namespace meshfront::testing {

class CheckingSink : public MeshSink {
 public:
  absl::Status Append(const MeshPiece& piece) override {
    ++pieces;
    for (const OutputVertex& v : piece.vertices) {
      if (!IsFinite(v.position)) Complain("a vertex is not finite");
      if (!(std::abs(Norm(v.normal) - 1) < 1e-6)) Complain("a normal is not of unit length");
    }
    finalised_.resize(finalised_.size() + piece.vertices.size(), false);
    for (const Triangle& t : piece.triangles) {
      for (const VertexId v : t) CheckUse(v);
    }
    for (const VertexId v : piece.finalised) {
      CheckUse(v);
      if (v.index() < finalised_.size()) finalised_[v.index()] = true;
    }
    last_open_front_edges = piece.open_front_edges;
    return collected_.Append(piece);
  }

  const TriangleMesh& mesh() const { return collected_.mesh; }
  // Empty when every promise was kept.
  const std::vector<std::string>& complaints() const { return complaints_; }
  // After the job: every vertex is finalised, none is left out of all triangles, no front is open.
  void CheckEnd() {
    if (std::count(finalised_.begin(), finalised_.end(), false) > 0) Complain("a vertex was never finalised");
    std::vector<bool> used(finalised_.size(), false);
    for (const Triangle& t : mesh().triangles) {
      for (const VertexId v : t) used[v.index()] = true;
    }
    if (std::count(used.begin(), used.end(), false) > 0) Complain("a vertex is in no triangle");
    if (last_open_front_edges != 0) Complain("front edges are left open");
  }
  int pieces = 0;
  uint64_t last_open_front_edges = 0;

 private:
  void Complain(std::string what) {
    if (complaints_.size() < 10) complaints_.push_back(std::move(what));
  }
  void CheckUse(VertexId v) {
    if (v.index() >= finalised_.size()) {
      Complain("vertex " + std::to_string(v.index()) + " is used before it was sent");
    } else if (finalised_[v.index()]) {
      Complain("vertex " + std::to_string(v.index()) + " is used after it was finalised");
    }
  }

  CollectingSink collected_;
  std::vector<bool> finalised_;
  std::vector<std::string> complaints_;
};

}  // namespace meshfront::testing
