// What triangle would this edge make, and may it? Placement of free triangles by two spheres (sec. 3.2), choice of the
// connection vertex, and the acceptance tests, each with its own verdict.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/front/fence_index.h"
#include "core/front/front_set.h"
#include "core/front/local_field.h"

namespace meshfront {

// Why a candidate was refused; the report counts them.
enum class Verdict : uint8_t {
  kAccepted,
  kNoApex,           // the spheres do not meet the surface on the open side
  kOutsideSector,    // leaves the open side at one of its corners
  kEdgeExists,       // an edge or the face exists already
  kNormalsDisagree,  // the triangle's normal against the surface's at its corners
  kTooClose,         // a front vertex or fence is nearer than the clearance
  kCrossesFence,
  kContainsVertex,  // a front vertex lies inside
  kTooLong,
  kOffSheet,  // does not stand for the surface: its sides or middle lie off the sheet
};
inline constexpr int kVerdicts = 10;
std::string_view VerdictName(Verdict verdict);

// How strict the acceptance tests are. The closing ladder relaxes them in named stages.
struct Strictness {
  std::string_view name;
  double min_normal_cosine;  // triangle against surface
  double clearance;          // of front vertices from new edges, in parts of the shorter of edge and g
  double range;              // search radius in multiples of kSearchRange
  double max_side;           // in multiples of kMaxSidePerGuidance · g
  double sheet_tolerance;    // distance of midpoints and centroid from the sheet, in parts of the longest side
};
inline constexpr std::array<Strictness, 4> kStrictness = {{{"strict", 0.5, 0.2, 1.0, 1.0, 0.35},
                                                           {"wide", 0.35, 0.1, 1.7, 1.8, 0.45},
                                                           {"tolerant", 0.15, 0.02, 2.0, 2.0, 0.6},
                                                           {"any", -0.2, 0.0, 3.0, 4.0, 1.0}}};
// For closing a loop along a knife's edge, where the surface's normals contradict each other: the least area, whatever they say.
inline constexpr Strictness kRegardlessOfNormals = {"regardless", -1.0, 0.0, 3.0, 4.0, 1.0};

struct FreeProposal {
  SourcePoint apex;
  bool at_guidance = true;  // its sides have the lengths that the field asks for; false where the base limits them
};
struct ConnectionProposal {
  FrontEdgeId corner;
  double score = -1;  // smallest of the angles of the triangle and of the corners left behind
};

// Looks, never touches. Not thread-safe (scratch).
class Proposer {
 public:
  Proposer(const Surface& surface, const FrontSet& fronts, const FenceIndex& fences);
  ~Proposer();

  // Radius ratio of the free triangle that `edge` would make, from lengths alone; 0 when there is none.
  double FreeRatio(FrontEdgeId edge) const;
  Verdict ProposeFree(FrontEdgeId edge, FreeProposal& proposal);
  // The better of the two connections with a neighbour on the loop, by shape and sectors alone: no fence is tested. Its score is a
  // lower bound of what ProposeConnection finds, unless a fence stands in the way. No corner when neither scores above `least_score`.
  enum class Neighbour : uint8_t { kBefore, kAfter, kEither };
  ConnectionProposal ProposeEar(FrontEdgeId edge, const Strictness& strictness, Neighbour with = Neighbour::kEither,
                                double least_score = -1) const;
  // The best connection by score; kAccepted or the verdict of the last candidate refused. By shape and sectors alone its score is an upper
  // bound, at a third of the cost.
  enum class Scrutiny : uint8_t { kShape, kWhole };
  Verdict ProposeConnection(FrontEdgeId edge, const Strictness& strictness, Scrutiny scrutiny,
                            ConnectionProposal& proposal);
  // Whether the connection may be made now, and its score now.
  Verdict CheckConnection(FrontEdgeId edge, const Strictness& strictness, ConnectionProposal& proposal);

  // Test 4: the sides that are new and the middle of the triangle lie within `tolerance` of the surface, on the same sheet.
  bool StandsForSurface(const SourcePoint& a, const SourcePoint& b, const SourcePoint& apex, bool new_side_a,
                        bool new_side_b, double tolerance) const;
  // Whether the loop of an edge goes around what is open, as seen from its corners' normals. O(loop).
  bool SurroundsOpenSide(FrontEdgeId edge) const;
  const std::array<uint64_t, kVerdicts>& counts() const { return counts_; }

 private:
  struct Candidate;
  struct NewFences;
  // A fence with a ball around it.
  struct Near {
    FrontEdgeId edge;
    Vec3 middle;
    double reach;
  };
  static FenceIndex::Ball BallAround(const NewEdge& edge);
  static bool MayCross(const FenceIndex::Ball& ball, const Near& fence);
  void Gather(FrontEdgeId of, const Vec3& center, double radius);
  Verdict Judge(Verdict verdict);
  // Where the apex of a free triangle would be on flat ground.
  struct FlatApex {
    Vec3 position, normal;
  };
  static std::optional<FlatApex> FindFlatApex(const WindowVertex& a, const WindowVertex& b, double radius_a,
                                              double radius_b);
  Verdict CheckNeighbours(FrontEdgeId edge, const FlatApex& apex, double step) const;
  bool IsFarTooClose(FrontEdgeId edge, const FlatApex& apex, double step) const;
  Verdict CheckFree(FrontEdgeId edge, const SourcePoint& apex, double step);
  void DescribeBase(FrontEdgeId edge, Candidate& candidate) const;
  void DescribeCorner(FrontEdgeId corner, Candidate& candidate) const;
  Verdict CheckShape(Candidate& c, const Strictness& strictness) const;
  Verdict CheckSectors(Candidate& c) const;
  static NewFences FencesOf(const Candidate& c, const Strictness& strictness);
  Verdict CheckFences(const Candidate& c, const NewFences& fences);
  bool Crosses(const NewEdge& edge, const SourcePoint& from, const SourcePoint& to, int side, FrontEdgeId fence);
  Verdict CheckSurroundings(const Candidate& c, const NewFences& fences, const Strictness& strictness);
  bool StandsForSurface(const Candidate& c, double tolerance);
  double SearchRadius(FrontEdgeId edge, const Strictness& strictness) const;

  const Surface& surface_;
  const FrontSet& fronts_;
  const FenceIndex& fences_;
  std::vector<FrontEdgeId> found_;
  std::vector<Near> near_;  // of the last Gather
  std::vector<Candidate> candidates_;
  std::array<uint64_t, kVerdicts> counts_{};
  // Ways over the surface, found when they are asked for: of the new sides of the candidate, and of front edges.
  struct NewWay {
    bool is_known = false;
    std::vector<WayPiece> pieces;
  };
  std::array<NewWay, 2> new_ways_;
  struct FenceWay {
    uint32_t birth = 0xffffffffu;
    std::vector<WayPiece> pieces;
  };
  std::vector<FenceWay> fence_ways_;
  // Answers of test 4, by the births of a candidate's edge and corner.
  struct SheetAnswer {
    uint32_t edge = 0, corner = 0;
    double tolerance = -1;  // in parts of the longest side
    bool zip_before = false, zip_after = false, stands = false;
  };
  static constexpr size_t kSheetAnswers = 1024;
  std::array<SheetAnswer, kSheetAnswers> sheet_answers_;
};

}  // namespace meshfront
