// Where no mesh of a region comes out right, the faces around what is wrong stay as they are, and the rest of it is tried again.
#pragma once

#include <cstdint>
#include <vector>

#include "core/attempts.h"
#include "core/geometry/vec3.h"
#include "core/preparation.h"

namespace meshfront {

// Faces of a region that are not remeshed though they were chosen.
struct LeftFaces {
  std::vector<bool> is_left;  // of each face of the whole; empty: none
  uint64_t count = 0;
  Vec3 first;      // where the first one is, in the input's scale
  int rounds = 0;  // of leaving more
};

// Adds the faces around the faults of a region's attempt: those within a reach that doubles from round to round, and their neighbours;
// from the third round on all that hang together with one of them. False, and nothing is added: there are no faults, or no faces of the
// region would be left to mesh, or it was tried often enough.
bool LeaveFaultyFaces(const Preparation& preparation, const Attempt& attempt, LeftFaces& left);

}  // namespace meshfront
