// A software rasteriser: a mesh as shaded faces with their edges drawn on top, hidden surfaces removed.
#pragma once

#include "client/cli/picture/canvas.h"
#include "client/cli/picture/view.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Draws the mesh (a point set as dots) into the rectangle, which keeps its background where there is no surface. Faces are blue
// grey when well shaped and turn orange the nearer they are to slivers (radius ratio); faces seen from behind are red.
// Faces with a vertex that is missing or not finite are left out. O(faces + pixels they cover).
void DrawWireframe(const TriangleMesh& mesh, const View& view, const PixelRect& rect, Canvas& canvas);

// The colours of the scale above, for a legend.
Color WellShapedColor();
Color SliverColor();

}  // namespace meshfront
