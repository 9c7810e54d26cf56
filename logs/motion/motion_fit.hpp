#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/target/target_model.hpp"

// Fit of linear motion models to recorded target motion, and their evaluation.

namespace vantage::logs {

/// Prediction horizons for fitting and evaluation, s. They span the time between two scans of a
/// target and the time for which it may be out of sight.
inline constexpr std::array<double, 5> kHorizons_s = {0.5, 1.0, 2.0, 4.0, 8.0};

/// Path of one target: its position at every multiple of kCourseStep_s, linearly interpolated
/// between the recorded positions.
class TargetCourse {
 public:
  static constexpr double kCourseStep_s = 0.1;
  static constexpr double kGapMax_s = 0.25;  ///< s; longer gaps are not interpolated

  /// Adds a recorded position. A position that is not later than the previous position is ignored.
  void add(Time time, const Eigen::Vector2d& position_m);
  /// Returns the positions, keyed by time in steps of kCourseStep_s.
  [[nodiscard]] const std::map<std::int64_t, Eigen::Vector2d>& positions_m() const {
    return places_m_;
  }

 private:
  std::map<std::int64_t, Eigen::Vector2d> places_m_;
  std::optional<Time> last_;
  Eigen::Vector2d last_m_ = Eigen::Vector2d::Zero();
};

/// Second moments of one coordinate y of targets about a centre: the joint moments of y(t + h),
/// y(t) and ẏ(t). They are sufficient to fit a linear model.
struct MotionMoments {
  std::int64_t samples = 0;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();  ///< sum of v vᵀ, v = (y(t+h), y(t), ẏ(t))

  /// Returns the mean of (wᵀ (y(t+h), y(t), ẏ(t)))²; 0 without samples.
  [[nodiscard]] double mean_square(const Eigen::Vector3d& weights) const;
  /// Returns the mean of (y(t+h) − a y(t) − b ẏ(t))²; 0 without samples.
  [[nodiscard]] double squared_error(double a, double b) const {
    return mean_square({1.0, -a, -b});
  }
};

/// Moments of the two coordinates for every horizon.
struct MotionSample {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  std::array<std::array<MotionMoments, kHorizons_s.size()>, 2> moments;

  /// Adds the part of a course from `from_share` to `to_share` of the time between `begin` and
  /// `end` (steps of a course). Predictions that end beyond that part are left out. Velocities are
  /// differences over the preceding step.
  void add(const TargetCourse& course, std::int64_t begin, std::int64_t end, double from_share,
           double to_share);
};

/// Mean of (y(t+h) − y(t))²: the squared displacement of one coordinate within h.
struct Displacement {
  double observed_m2 = 0.0;   ///< m²; in the recorded motion
  double predicted_m2 = 0.0;  ///< m²; predicted by a model from the same positions and velocities
};

/// Quality of a model's position predictions for horizon h, from position and velocity: the
/// position part of N(c + A (y − c), W).
struct MotionScore {
  double nats = 0.0;  ///< mean log likelihood of a position over the horizons; higher is better
  /// Mean NEES of the position; 2 for a consistent model.
  std::array<double, kHorizons_s.size()> nees{};
  std::array<std::array<Displacement, kHorizons_s.size()>, 2> displacements{};  ///< per coordinate
};
MotionScore judge(const models::TargetModel& model, const MotionSample& sample);

/// Returns the model of `kind` (random walk or double integrator) with the most likely q: the mean
/// over coordinates and horizons of the squared error divided by the variance for q = 1.
models::TargetModel fit_free(models::TargetKind kind, const MotionSample& sample);
/// Returns the most likely damped oscillator, fitted separately for each coordinate by a simplex
/// search over the logarithms of σ_p, σ_v and γ. Source: Nelder, Mead (1965).
models::TargetModel fit_oscillator(const MotionSample& sample);

/// A model fitted to the first part of the time and evaluated on both parts.
struct FittedMotion {
  models::TargetModel model;
  MotionScore fitted;
  MotionScore held_back;
};

/// Fits random walk, double integrator and damped oscillator about `center_m`.
/// @param fitted_share  share of the time from the first to the last position, over all courses of
/// a log, that is used for the fit; the rest is used only for the evaluation
/// @throws UsageError if a horizon has no prediction in one of the parts.
std::vector<FittedMotion> fit_motion(std::span<const std::vector<TargetCourse>> logs,
                                     const Eigen::Vector2d& center_m, double fitted_share = 0.7);

}  // namespace vantage::logs
