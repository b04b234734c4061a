// One line on a terminal that says how far a job is.
#pragma once

#include <chrono>
#include <cstdint>
#include <ostream>
#include <string>

namespace meshfront {

struct JobProgress {
  std::string stage;                 // as in the stats: "index", …, "mesh"
  uint64_t predicted_triangles = 0;  // 0: not known yet
  uint64_t triangles = 0;
};

// "mesh [#########-----------] 45%  12,345 of 27,000 triangles  310k/s  0:02 left", or the name of the stage while no triangle has come.
// `seconds` since meshing began.
std::string ProgressLine(const JobProgress& progress, double seconds);

// Redraws the line at most ten times a second and wipes it at the end.
class ProgressBar {
 public:
  // Silent when `enabled` is false.
  ProgressBar(std::ostream& out, bool enabled) : out_(out), enabled_(enabled) {}
  ~ProgressBar() { Clear(); }
  void Update(const JobProgress& progress);
  void Clear();

 private:
  using Clock = std::chrono::steady_clock;

  std::ostream& out_;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point last_drawn_{}, meshing_since_{};
};

}  // namespace meshfront
