// The parameter of which a wanted number of triangles comes out.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshfront {

// Finds the root of a falling function on a line, known at a growing number of places; the line ends at `last` on the right. Called by
// FieldBuilder with logarithms: of the sizing's parameter, and of the count.
class CountSearch {
 public:
  // `slope`: of the function, to begin with.
  CountSearch(double log_target, double exponent, double slope, double last)
      : log_target_(log_target), exponent_(exponent), slope_(slope), last_(last) {}

  // Takes in what the count is at a place, and says where to try next.
  double Next(double place, double log_count) {
    if (std::isfinite(place_)) {
      slope_ = std::clamp((log_count - log_count_) / (place - place_), 2 * exponent_, 0.02 * exponent_);
      const double step = std::abs(place - place_);
      has_stopped_ =
          log_count < log_target_ && step >= kTellingStep && std::abs(log_count - log_count_) < kSameCount * step;
    }
    place_ = place, log_count_ = log_count;
    (log_count > log_target_ ? left_ : right_) = place;
    const double next = std::min(last_, place + std::clamp((log_target_ - log_count) / slope_, -kMaxStep, kMaxStep));
    if ((next > left_ && next < right_) || std::isinf(left_) || std::isinf(right_)) return next;
    return 0.5 * (left_ + right_);
  }
  double slope() const { return slope_; }  // where it was asked last
  // More on the left and fewer on the right, and hardly anything between.
  bool IsAtAJump() const { return right_ - left_ < kJump; }
  // The place has lost its influence on the count, or there is no other on the side where the target lies.
  bool IsExhausted() const { return has_stopped_ || (place_ >= last_ && log_count_ > log_target_); }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // Of the parameter's logarithm: of one step at most, what tells whether the count still follows it, and a jump of the count.
  static constexpr double kMaxStep = 1.5, kTellingStep = 0.5, kJump = 1e-3;
  static constexpr double kSameCount = 1e-4;  // of the count's logarithm: the parameter has lost its influence

  double log_target_, exponent_, slope_, last_;
  double left_ = -kInfinity, right_ = kInfinity;  // places with more, and with fewer
  double place_ = kInfinity, log_count_ = 0;
  bool has_stopped_ = false;
};

}  // namespace meshfront
