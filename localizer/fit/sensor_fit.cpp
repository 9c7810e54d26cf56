#include "localizer/fit/sensor_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "localizer/commanded_motion.hpp"
#include "localizer/sighting_model.hpp"

namespace vantage::localizer {
namespace {

constexpr int kSamplesMin = 100;
constexpr double kMadToSigma = 1.4826;  // σ of a Gaussian divided by its median absolute deviation
// Assumed 1σ of sightings while the geometry is fitted.
constexpr double kRangeSigmaM = 0.018;
constexpr double kRangeSigmaPerM = 0.0013;
constexpr double kBearingSigmaRad = 0.006;
constexpr double kOutlierSigma = 6.0;
// m; the bearing of a nearer body depends on where the code is on the body
constexpr double kNearM = 1.5;

double median_of(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Returns the robust 1σ of errors with mean 0.
double sigma_of(std::vector<double> errors) {
  for (double& error : errors) {
    error = std::abs(error);
  }
  return kMadToSigma * median_of(std::move(errors));
}

struct Sample {
  Time stamp{};
  Eigen::Vector2d landmark_m = Eigen::Vector2d::Zero();
  double range_m = 0.0;
  double bearing_rad = 0.0;
};

scenario::SightingSpec sensor_of(const Eigen::VectorXd& p, bool is_depth) {
  return {is_depth, p(0), p(1), is_depth ? p(5) : 0.0, p(2), p(3), p(4)};
}

std::vector<Sample> samples_of(const std::vector<scenario::LandmarkSpec>& landmarks,
                               const RobotRecording& recording) {
  // Largest delay of the stamp for which true poses must exist.
  constexpr Duration kMargin = std::chrono::milliseconds(250);
  std::vector<Sample> samples;
  for (const SightingFrame& frame : recording.frames) {
    if (!recording.truth.at(frame.stamp) || !recording.truth.at(frame.stamp - kMargin)) {
      continue;
    }
    for (const models::Sighting& sighting : frame.sightings) {
      const auto landmark =
          std::find_if(landmarks.begin(), landmarks.end(),
                       [&](const scenario::LandmarkSpec& each) { return each.id == sighting.id; });
      if (landmark != landmarks.end()) {
        samples.push_back(
            {frame.stamp, landmark->position_m, sighting.range_m, sighting.bearing_rad});
      }
    }
  }
  return samples;
}

/// Errors of one sighting and the distance of the landmark.
struct SightingError {
  double range_m = 0.0;
  double bearing_rad = 0.0;
  double distance_m = 0.0;
};

SightingError error_of(const Sample& sample, const scenario::SightingSpec& sensor,
                       const TruePath& truth) {
  const auto pose = truth.at(sample.stamp - from_seconds(sensor.stamp_delay_s));
  if (!pose) {
    return {0.0, 0.0, 1.0};
  }
  const ExpectedSighting expected = expected_sighting(sensor, *pose, sample.landmark_m);
  return {sample.range_m - expected.range_m, wrap_to_pi(sample.bearing_rad - expected.bearing_rad),
          expected.distance_m};
}

/// Sets the noise of `fit` from the errors of its sensor.
void fit_noise(const std::vector<SightingError>& errors, SensorFit& fit) {
  // Computes the robust σ of the range in classes of distance, then fits a line over the squared
  // distance.
  constexpr std::array<double, 6> kEdgesM = {0.0, 2.0, 3.0, 4.0, 5.0, 8.0};
  constexpr std::size_t kClassMin = 20;
  double weight = 0.0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t k = 0; k + 1 < kEdgesM.size(); ++k) {
    std::vector<double> ranges;
    std::vector<double> squares;
    for (const SightingError& error : errors) {
      if (error.distance_m >= kEdgesM[k] && error.distance_m < kEdgesM[k + 1]) {
        ranges.push_back(error.range_m);
        squares.push_back(error.distance_m * error.distance_m);
      }
    }
    if (ranges.size() < kClassMin) {
      continue;
    }
    const auto n = static_cast<double>(ranges.size());
    const double square = median_of(squares);
    const double sigma = sigma_of(std::move(ranges));
    weight += n;
    x += n * square;
    y += n * sigma;
    xx += n * square * square;
    xy += n * square * sigma;
  }
  const double spread = weight * xx - x * x;
  fit.range_sigma_per_m = spread > 0.0 ? std::max(0.0, (weight * xy - x * y) / spread) : 0.0;
  fit.range_sigma_m = weight > 0.0 ? std::max(1e-3, (y - fit.range_sigma_per_m * x) / weight) : 0.0;
  std::vector<double> bearings;
  for (const SightingError& error : errors) {
    if (error.distance_m > kNearM) {
      bearings.push_back(error.bearing_rad);
    }
  }
  fit.bearing_sigma_rad = std::max(1e-4, sigma_of(std::move(bearings)));
  int outliers = 0;
  for (const SightingError& error : errors) {
    const double range_sigma_m =
        fit.range_sigma_m + fit.range_sigma_per_m * error.distance_m * error.distance_m;
    outliers += std::abs(error.range_m) > kOutlierSigma * range_sigma_m ||
                        std::abs(error.bearing_rad) > kOutlierSigma * fit.bearing_sigma_rad
                    ? 1
                    : 0;
  }
  fit.outliers = static_cast<double>(outliers) / static_cast<double>(errors.size());
}

/// Returns the share of expected detections that happened. A landmark is expected if it is well
/// inside the bearings and ranges of the sightings (their 2 % and 98 % quantiles).
double detection_probability_of(const std::vector<scenario::LandmarkSpec>& landmarks,
                                const RobotRecording& recording,
                                const scenario::SightingSpec& sensor,
                                const std::vector<Sample>& samples) {
  std::vector<double> bearings;
  std::vector<double> ranges;
  for (const Sample& sample : samples) {
    bearings.push_back(sample.bearing_rad);
    ranges.push_back(sample.range_m);
  }
  std::sort(bearings.begin(), bearings.end());
  std::sort(ranges.begin(), ranges.end());
  const auto quantile = [](const std::vector<double>& sorted, double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  int expected_count = 0;
  int detected = 0;
  for (const SightingFrame& frame : recording.frames) {
    const auto pose = recording.truth.at(frame.stamp - from_seconds(sensor.stamp_delay_s));
    if (!pose) {
      continue;
    }
    for (const scenario::LandmarkSpec& landmark : landmarks) {
      const ExpectedSighting expected = expected_sighting(sensor, *pose, landmark.position_m);
      if (expected.bearing_rad < quantile(bearings, 0.02) ||
          expected.bearing_rad > quantile(bearings, 0.98) ||
          expected.range_m < quantile(ranges, 0.02) || expected.range_m > quantile(ranges, 0.98)) {
        continue;
      }
      ++expected_count;
      detected += std::any_of(frame.sightings.begin(), frame.sightings.end(),
                              [&](const models::Sighting& each) { return each.id == landmark.id; })
                      ? 1
                      : 0;
    }
  }
  return expected_count == 0 ? 0.0 : static_cast<double>(detected) / expected_count;
}

}  // namespace

SensorFit fit_sensor(const std::vector<scenario::LandmarkSpec>& landmarks,
                     const RobotRecording& recording, std::optional<double> stamp_delay_s) {
  const std::vector<Sample> samples = samples_of(landmarks, recording);
  require(samples.size() >= kSamplesMin,
          "at least 100 sightings of landmarks with a true pose are needed; the log has " +
              std::to_string(samples.size()));
  SensorFit best;
  double best_loss = std::numeric_limits<double>::infinity();
  for (const bool is_depth : {false, true}) {
    // Parameters: scale, offset, bearing offset, forward, stamp delay and, if the range is a depth,
    // the axis.
    Eigen::VectorXd start = Eigen::VectorXd::Zero(is_depth ? 6 : 5);
    start(0) = 1.0;
    start(4) = 0.03;
    Eigen::VectorXd steps = Eigen::VectorXd::Constant(start.size(), 1e-3);
    steps(4) = 5e-3;
    const auto fitted_sensor = [&](const Eigen::VectorXd& p) {
      scenario::SightingSpec sensor = sensor_of(p, is_depth);
      sensor.stamp_delay_s = stamp_delay_s.value_or(sensor.stamp_delay_s);
      return sensor;
    };
    const auto residuals = [&](const Eigen::VectorXd& p, std::vector<double>& out) {
      const scenario::SightingSpec sensor = fitted_sensor(p);
      out.clear();
      for (const Sample& sample : samples) {
        const SightingError error = error_of(sample, sensor, recording.truth);
        const double sigma_m = kRangeSigmaM + kRangeSigmaPerM * error.distance_m * error.distance_m;
        out.push_back(error.range_m / sigma_m);
        out.push_back(error.bearing_rad / kBearingSigmaRad);
      }
    };
    double loss = 0.0;
    const Eigen::VectorXd fitted = robust_fit(start, steps, residuals, loss);
    const double mean_loss = loss / static_cast<double>(samples.size());
    (is_depth ? best.depth_loss : best.distance_loss) = mean_loss;
    if (mean_loss < best_loss) {
      best_loss = mean_loss;
      best.sensor = fitted_sensor(fitted);
    }
  }
  best.sightings = static_cast<int>(samples.size());
  std::vector<SightingError> errors;
  errors.reserve(samples.size());
  for (const Sample& sample : samples) {
    errors.push_back(error_of(sample, best.sensor, recording.truth));
  }
  fit_noise(errors, best);
  best.detection_probability = detection_probability_of(landmarks, recording, best.sensor, samples);
  return best;
}

namespace {

constexpr double kWindowS = 0.2;
constexpr double kTurnSigmaRad = 0.005;  // 1σ of a window's turn, assumed while the drive is fitted
constexpr double kMoveSigmaM = 0.002;

/// True and commanded motion of one robot in time windows.
struct Windows {
  std::vector<double> true_turn_rad;
  std::vector<double> true_move_m;
  std::vector<double> turn_rad;
  std::vector<double> move_m;
};

/// True motion in consecutive windows; a window without true poses has NaN.
struct TrueWindows {
  Time begin{};
  std::vector<double> turn_rad;
  std::vector<double> move_m;
};

TrueWindows true_windows_of(const RobotRecording& recording) {
  constexpr Duration kWarmUp = std::chrono::seconds(1);
  const Duration window = from_seconds(kWindowS);
  TrueWindows out;
  out.begin = std::max(recording.odometry.front().stamp.time, recording.truth.begin()) + kWarmUp;
  const Time end = std::min(recording.odometry.back().stamp.time, recording.truth.end());
  for (Time from = out.begin; from + window <= end; from += window) {
    const auto a = recording.truth.at(from);
    const auto b = recording.truth.at(from + window);
    double turn_rad = std::numeric_limits<double>::quiet_NaN();
    double move_m = turn_rad;
    if (a && b) {
      turn_rad = wrap_to_pi(b->yaw_rad - a->yaw_rad);
      const double middle_rad = a->yaw_rad + 0.5 * turn_rad;
      move_m = (b->x_m - a->x_m) * std::cos(middle_rad) + (b->y_m - a->y_m) * std::sin(middle_rad);
    }
    out.turn_rad.push_back(turn_rad);
    out.move_m.push_back(move_m);
  }
  return out;
}

/// Computes the windows of the commands with the given delay and lag. `merge`: number of windows
/// that are joined to one.
Windows windows_of(const RobotRecording& recording, const TrueWindows& truth, double delay_s,
                   double lag_s, std::size_t merge) {
  const Duration window = from_seconds(kWindowS);
  CommandedMotion motion({.delay_s = delay_s, .lag_s = lag_s});
  std::size_t next = 0;
  const auto feed = [&](Time until) {
    for (; next < recording.odometry.size() && recording.odometry[next].stamp.time <= until;
         ++next) {
      const models::OdometryReport& each = recording.odometry[next];
      motion.command(each.stamp.time, each.motion_body.x(), each.motion_body.z());
    }
  };
  // Start at the first command, so that the response has its true speed at the first window.
  static_cast<void>(motion.advance_to(recording.odometry.front().stamp.time));
  for (Time time = recording.odometry.front().stamp.time; time < truth.begin; time += window) {
    feed(time);
    static_cast<void>(motion.advance_to(std::min(time, truth.begin)));
  }
  feed(truth.begin);
  static_cast<void>(motion.advance_to(truth.begin));
  Windows out;
  double true_turn_rad = 0.0;
  double true_move_m = 0.0;
  double turn_rad = 0.0;
  double move_m = 0.0;
  for (std::size_t k = 0; k < truth.turn_rad.size(); ++k) {
    const Time end = truth.begin + (static_cast<std::int64_t>(k) + 1) * window;
    feed(end);
    const Eigen::Vector3d moved = motion.advance_to(end);
    true_turn_rad += truth.turn_rad[k];
    true_move_m += truth.move_m[k];
    turn_rad += moved.z();
    move_m += moved.head<2>().norm() * (moved.x() < 0.0 ? -1.0 : 1.0);
    if ((k + 1) % merge != 0) {
      continue;
    }
    if (std::isfinite(true_turn_rad) && std::isfinite(true_move_m)) {
      out.true_turn_rad.push_back(true_turn_rad);
      out.true_move_m.push_back(true_move_m);
      out.turn_rad.push_back(turn_rad);
      out.move_m.push_back(move_m);
    }
    true_turn_rad = true_move_m = turn_rad = move_m = 0.0;
  }
  return out;
}

/// Returns the response with the least loss.
Response find_response(const RobotRecording& recording, const TrueWindows& truth) {
  const auto loss_of = [&](double delay_s, double lag_s) {
    const Windows windows = windows_of(recording, truth, delay_s, lag_s, 1);
    double scale = 1.0;
    double offset = 0.0;
    return robust_line(windows.turn_rad, windows.true_turn_rad, kTurnSigmaRad, true, scale,
                       offset) +
           robust_line(windows.move_m, windows.true_move_m, kMoveSigmaM, false, scale, offset);
  };
  return least_loss_response(loss_of);
}

}  // namespace

DriveFit fit_drive(const RobotRecording& recording, std::optional<Response> response) {
  require(!recording.odometry.empty() && !recording.truth.empty(),
          "the robot must have odometry and true poses");
  const TrueWindows truth = true_windows_of(recording);
  const auto [delay_s, lag_s] = response ? *response : find_response(recording, truth);
  DriveFit fit;
  fit.drive.delay_s = delay_s;
  fit.drive.lag_s = lag_s;
  const Windows windows = windows_of(recording, truth, delay_s, lag_s, 1);
  fit.windows = static_cast<int>(windows.turn_rad.size());
  require(fit.windows >= kSamplesMin,
          "at least 100 windows of 0.2 s with true poses are needed; the log has " +
              std::to_string(fit.windows));
  // Windows of 1 s give scales and bias, because their relative errors are smaller.
  constexpr std::size_t kMerge = 5;
  const Windows merged = windows_of(recording, truth, delay_s, lag_s, kMerge);
  double turn_offset_rad = 0.0;
  double none = 0.0;
  robust_line(merged.turn_rad, merged.true_turn_rad, 2.0 * kTurnSigmaRad, true,
              fit.drive.turn_scale, turn_offset_rad);
  robust_line(merged.move_m, merged.true_move_m, 2.0 * kMoveSigmaM, false, fit.drive.speed_scale,
              none);
  fit.drive.turn_bias_radps = turn_offset_rad / (kWindowS * static_cast<double>(kMerge));
  std::vector<double> turns;
  std::vector<double> moves;
  for (std::size_t k = 0; k < windows.turn_rad.size(); ++k) {
    turns.push_back(windows.true_turn_rad[k] - fit.drive.turn_scale * windows.turn_rad[k] -
                    fit.drive.turn_bias_radps * kWindowS);
    moves.push_back(windows.true_move_m[k] - fit.drive.speed_scale * windows.move_m[k]);
  }
  fit.turn_sigma_rad = sigma_of(std::move(turns));
  fit.move_sigma_m = sigma_of(std::move(moves));
  return fit;
}

}  // namespace vantage::localizer
