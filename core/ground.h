// Whether a front may fail on a surface: how it turns at its edges, beside the creases that it is cut along.
#pragma once

#include "core/guidance/guidance_field.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

struct Ground {
  // So many edges turn sharply, by more than 80°, that the front may fail somewhere.
  bool is_rough = false;
  // One turns all but back, by more than 150°, and is so long that edges of the output will run along it: no front tells the sheets
  // apart there.
  bool folds_back = false;
};

Ground GroundOf(const MeshSurface& surface, const GuidanceField& field);

}  // namespace meshfront
