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

// How targets really move, and which linear model says so best.

namespace vantage::logs {

/// For so long ahead motion models are fitted and judged, s: what passes between two looks at a
/// target, and how long it may be out of sight.
inline constexpr std::array<double, 5> kHorizons_s = {0.5, 1.0, 2.0, 4.0, 8.0};

/// The way of one target: its place at every whole kCourseStep_s, between what was seen before and
/// after by a straight line.
class TargetCourse {
 public:
  static constexpr double kCourseStep_s = 0.1;
  static constexpr double kGapMax_s = 0.25;  ///< over longer ones nothing is guessed

  /// Places not later than the one before are left out.
  void add(Time time, const Eigen::Vector2d& position_m);
  /// By their instant, in steps.
  [[nodiscard]] const std::map<std::int64_t, Eigen::Vector2d>& places_m() const {
    return places_m_;
  }

 private:
  std::map<std::int64_t, Eigen::Vector2d> places_m_;
  std::optional<Time> last_;
  Eigen::Vector2d last_m_ = Eigen::Vector2d::Zero();
};

/// Second moments of one coordinate y of targets about a centre: how y(t + h) depends on y(t) and
/// ẏ(t). All that a linear model can be fitted to.
struct MotionMoments {
  std::int64_t samples = 0;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();  ///< of (y(t+h), y(t), ẏ(t)) times its transpose

  /// Mean of (wᵀ (y(t+h), y(t), ẏ(t)))²; 0 without samples.
  [[nodiscard]] double mean_square(const Eigen::Vector3d& weights) const;
  /// Mean of (y(t+h) − a y(t) − b ẏ(t))²; 0 without samples.
  [[nodiscard]] double squared_error(double a, double b) const {
    return mean_square({1.0, -a, -b});
  }
};

/// Of both coordinates and every horizon.
struct MotionSample {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  std::array<std::array<MotionMoments, kHorizons_s.size()>, 2> moments;

  /// Adds what a course tells from `from_share` to `to_share` of the time between `begin` and
  /// `end` (steps of a course), predictions that reach beyond left out. Velocities are differences
  /// over the step before.
  void add(const TargetCourse& course, std::int64_t begin, std::int64_t end, double from_share,
           double to_share);
};

/// Mean of (y(t+h) − y(t))²: how far one coordinate of targets got in h.
struct Displacement {
  double seen_m2 = 0.0;
  double foretold_m2 = 0.0;  ///< what a model expects from the same places and velocities
};

/// How well a model foretells positions, h ahead from position and velocity: N(c + A (y − c), W)
/// by its position part.
struct MotionScore {
  double nats = 0.0;  ///< mean log likelihood of a position over the horizons; more is better
  std::array<double, kHorizons_s.size()> nees{};  ///< mean squared error in σ; 2 is right
  std::array<std::array<Displacement, kHorizons_s.size()>, 2> displacements{};  ///< by coordinate
};
MotionScore judge(const models::TargetModel& model, const MotionSample& sample);

/// The most likely q of `kind`, random walk or double integrator: mean over coordinates and
/// horizons of the squared error by what q = 1 adds.
models::TargetModel fit_free(models::TargetKind kind, const MotionSample& sample);
/// The most likely damped oscillator, each coordinate by itself, by a simplex search over the
/// logarithms of σ_p, σ_v and γ. Source: Nelder, Mead (1965).
models::TargetModel fit_oscillator(const MotionSample& sample);

/// A model fitted to the first part of the time and judged on the rest.
struct FittedMotion {
  models::TargetModel model;
  MotionScore fitted;
  MotionScore held_back;
};

/// Of random walk, double integrator and damped oscillator about `center_m`.
/// @param fitted_share  of the time from the first place to the last, over all courses of a log;
///                      the rest is held back
/// @throws UsageError when there is no prediction of some horizon in either part.
std::vector<FittedMotion> fit_motion(std::span<const std::vector<TargetCourse>> logs,
                                     const Eigen::Vector2d& center_m, double fitted_share = 0.7);

}  // namespace vantage::logs
