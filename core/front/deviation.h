// How far a triangle of the output is from the surface, with a bound between the places that are looked at (engine sec. 3, error
// mode). Distances are absolute.
#pragma once

#include <array>
#include <vector>

#include "core/surface/surface.h"

namespace meshfront {

// A place of a triangle and the surface's next to it.
struct PlaceAndFoot {
  Vec3 place;
  SourcePoint foot;
  double Gap() const { return Distance(place, foot.position); }
  bool operator==(const PlaceAndFoot& other) const {
    return place == other.place && foot.patch == other.foot.patch && foot.position == other.foot.position &&
           foot.u == other.foot.u && foot.v == other.foot.v && foot.normal == other.foot.normal;
  }
};

struct Deviation {
  double largest = 0;         // of the places that were looked at, where they are beyond the bound
  PlaceAndFoot worst;         // where
  bool is_kept = true;        // nowhere beyond the bound
  bool is_of_detail = false;  // the worst is a place of the surface that is far from all triangles around
};

// Measures triangles against one bound. Scratch inside: one for each thread.
class DeviationMeter {
 public:
  // `certain`: what can't be shown to keep the bound does not; else what was not seen to exceed it keeps it.
  DeviationMeter(const Surface& surface, double bound, bool certain = true)
      : surface_(surface), bound_(bound), certain_(certain) {}

  // Whether a triangle seems to keep the bound by far: its corners, its centroid and, unless these are so near that the surface's bend
  // between them tells enough, the middles of its sides are near, and it does not turn away from the surface. True of most triangles, and
  // wrong of one in some hundreds of those that are near the bound. `centroid_foot`: else it is walked to.
  bool SeemsNear(const std::array<PlaceAndFoot, 3>& corners, const Vec3* centroid_foot) const;

  // Whether a triangle stays within the bound of the surface. The feet of the corners are starting points of walks, on the surface
  // next to the corners, and need not be closest.
  //
  // Where the surface can tell of all places that are far along the triangle's normal (Surface::FindFarPlaces), there are none in
  // most triangles, and those are walked from else. What is doubtful then, or all of the triangle where it can't tell, is halved until
  // each part is known to keep the bound (SettleParts). A surface of pieces: what is kept is kept everywhere, and where that can't be shown
  // it is taken as exceeded. Other surfaces: the distance is measured at the middles of the sides, and so on in the four parts that they
  // make, wherever the parts' corners and the surface's bend between them can't rule out more than the bound; so that between those places
  // it may be more by what the distance grows over a 128th of a side.
  Deviation Measure(const std::array<PlaceAndFoot, 3>& corners);
  // The surface's corners that the last Measure found farther from the triangle, along its normal, than the bound: perhaps from other
  // triangles, too. Not certain: what of the surface crosses the triangle's sides there as well, a ridge between two corners is as far.
  const std::vector<FarPlace>& far_details() const { return far_details_; }
  void set_bound(double bound) { bound_ = bound; }

 private:
  void Note(const PlaceAndFoot& at);
  void Examine(bool all);
  void SettleParts();
  double MostOver(const std::array<PlaceAndFoot, 3>& corners) const;
  void Halve(const std::array<PlaceAndFoot, 3>& corners, int halvings);
  double SlopeAt(const PlaceAndFoot& at) const;
  PlaceAndFoot Closest(const SourcePoint& start, const Vec3& place) const;
  void NoteFar();
  PlaceAndFoot Middle(const PlaceAndFoot& a, const PlaceAndFoot& b);

  const Surface& surface_;
  double bound_;
  const bool certain_;
  std::array<PlaceAndFoot, 3> corners_;
  Vec3 normal_;
  Deviation found_;
  std::vector<FarPlace> far_, far_details_;
  std::vector<DoubtfulPart> doubtful_;
  std::vector<std::array<PlaceAndFoot, 3>> parts_;
};

}  // namespace meshfront
