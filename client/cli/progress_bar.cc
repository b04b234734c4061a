#include "client/cli/progress_bar.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/text.h"

namespace meshfront {
namespace {

constexpr int kBarWidth = 24;
constexpr auto kRedrawInterval = std::chrono::milliseconds(100);
constexpr double kFirstEstimate = 0.3;  // seconds of meshing before a rate is worth showing

std::string Rate(double per_second) {
  if (per_second >= 1e6) return absl::StrFormat("%.1fM/s", per_second / 1e6);
  return per_second >= 1e3 ? absl::StrFormat("%.0fk/s", per_second / 1e3) : absl::StrFormat("%.0f/s", per_second);
}

}  // namespace

std::string ProgressLine(const JobProgress& progress, double seconds) {
  if (progress.triangles == 0) return absl::StrCat(progress.stage, " …");
  // The prediction is some percent off either way: the bar is full only when the job says so.
  const double share = progress.predicted_triangles == 0
                           ? 0
                           : std::min(0.99, static_cast<double>(progress.triangles) / progress.predicted_triangles);
  const int filled = static_cast<int>(share * kBarWidth);
  std::string line =
      absl::StrCat(progress.stage, " [", std::string(filled, '#'), std::string(kBarWidth - filled, '-'), "] ");
  absl::StrAppendFormat(&line, "%2d%%  %s", static_cast<int>(100 * share), WithThousands(progress.triangles));
  if (progress.predicted_triangles > 0) absl::StrAppend(&line, " of ", WithThousands(progress.predicted_triangles));
  absl::StrAppend(&line, " triangles");
  if (seconds < kFirstEstimate) return line;
  const double rate = progress.triangles / seconds;
  absl::StrAppend(&line, "  ", Rate(rate));
  if (progress.predicted_triangles <= progress.triangles) return line;
  const int left = static_cast<int>((progress.predicted_triangles - progress.triangles) / rate + 0.5);
  absl::StrAppendFormat(&line, "  %d:%02d left", left / 60, left % 60);
  return line;
}

void ProgressBar::Update(const JobProgress& progress) {
  if (!enabled_) return;
  const Clock::time_point now = Clock::now();
  if (progress.triangles > 0 && meshing_since_ == Clock::time_point{}) meshing_since_ = now;
  if (drawn_ && now - last_drawn_ < kRedrawInterval) return;
  last_drawn_ = now;
  drawn_ = true;
  const double seconds = progress.triangles > 0 ? std::chrono::duration<double>(now - meshing_since_).count() : 0;
  out_ << "\r\x1b[K" << ProgressLine(progress, seconds) << std::flush;
}

void ProgressBar::Clear() {
  if (drawn_) out_ << "\r\x1b[K" << std::flush;
  drawn_ = false;
}

}  // namespace meshfront
