#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/angle.hpp"
#include "localizer/commanded_motion.hpp"
#include "localizer/sighting_model.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::test {

/// Robots that drive arcs among landmarks, with the errors that the specification states.
class SimulatedTeam {
 public:
  static constexpr double kStep_s = 0.1;

  SimulatedTeam(int robots, unsigned seed) : rng_(seed) {
    for (int k = 0; k < 12; ++k) {
      const double angle_rad = 2.0 * kPi * k / 12.0;
      spec.landmarks.push_back({100 + k, {6.0 * std::cos(angle_rad), 4.0 * std::sin(angle_rad)}});
    }
    landmarks = spec.landmarks;
    for (int r = 0; r < robots; ++r) {
      scenario::LocalizedRobotSpec robot;
      robot.name = "R" + std::to_string(r + 1);
      robot.id = r + 1;
      robot.sightings = {true, 1.02, 0.05, 0.01, 0.0, 0.05, 0.03};
      robot.drive = {0.15, 0.1, 1.01, 0.97, -0.001};
      spec.robots.push_back(robot);
      truth.push_back({0.8 * r - 1.6, 0.5 * (r % 2), 0.7 * r});
      motions_.emplace_back(robot.drive);
      static_cast<void>(motions_.back().advance_to(now));
      turn_error_radps_.push_back(spec.odometry_noise.turn_drift_radps * normal());
      speed_error_.push_back(spec.odometry_noise.speed_drift_share * normal());
    }
    commands.resize(truth.size());
    frames.resize(truth.size());
  }

  /// Moves the team by kStep_s. Fills `commands` and `frames` with the new data of each robot.
  void step() {
    const scenario::OdometryNoiseSpec& noise = spec.odometry_noise;
    const Time next = now + from_seconds(kStep_s);
    for (std::size_t r = 0; r < truth.size(); ++r) {
      commands[r].kind = models::OdometryKind::kCommand;
      commands[r].stamp.time = now;
      commands[r].robot = spec.robots[r].name;
      const double phase = to_seconds(now.time_since_epoch()) / (8.0 + static_cast<double>(r));
      commands[r].motion_body = {0.15 + 0.05 * std::sin(phase), 0.0, 0.25 * std::cos(phase)};
      motions_[r].command(now, commands[r].motion_body.x(), commands[r].motion_body.z());
      const Eigen::Vector3d moved = motions_[r].advance_to(next);
      const double forward_m = moved.x() * (1.0 + speed_error_[r]);
      const double slide_m = noise.slide_sigma_per_sqrt_m * std::sqrt(std::abs(moved.x()));
      const double turn_sigma_rad =
          std::hypot(noise.turn_sigma_rad_per_sqrt_s * std::sqrt(kStep_s),
                     noise.turn_sigma_per_sqrt_rad * std::sqrt(std::abs(moved.z())));
      truth[r] =
          truth[r] * Pose2{forward_m + slide_m * normal(), moved.y() + slide_m * normal(),
                           moved.z() + turn_error_radps_[r] * kStep_s + turn_sigma_rad * normal()};
      renew(turn_error_radps_[r], noise.turn_drift_radps, noise.turn_drift_time_s);
      renew(speed_error_[r], noise.speed_drift_share, noise.speed_drift_time_s);
    }
    now = next;
    for (std::size_t r = 0; r < truth.size(); ++r) {
      look(r);
    }
  }

  [[nodiscard]] double normal() { return std::normal_distribution<double>()(rng_); }

  scenario::LocalizerSpec spec;
  Time now = from_utime(1'000'000'000'000'000);
  std::vector<scenario::LandmarkSpec> landmarks;  ///< in the world; `spec` may know fewer
  std::vector<Pose2> truth;
  std::vector<models::OdometryReport> commands;
  std::vector<std::vector<models::Sighting>> frames;
  double wrong_ids = 0.0;  ///< probability that a sighting has a wrong id

 private:
  void renew(double& error, double sigma, double time_s) {
    const double keep = std::exp(-kStep_s / time_s);
    error = keep * error + sigma * std::sqrt(1.0 - keep * keep) * normal();
  }

  void look(std::size_t r) {
    const scenario::SightingNoiseSpec& noise = spec.sighting_noise;
    frames[r].clear();
    const double shared_rad = noise.frame_bearing_sigma_rad * normal();
    const auto add = [&](int id, const Eigen::Vector2d& point_m) {
      const auto expected =
          localizer::expected_sighting(spec.robots[r].sightings, truth[r], point_m);
      if (std::abs(expected.bearing_rad) > 0.6 || expected.distance_m > 6.0 ||
          expected.distance_m < 0.4) {
        return;
      }
      const double d = expected.distance_m;
      const double range_sigma_m = noise.range_sigma_m + noise.range_sigma_per_m * d * d;
      const double bearing_sigma_rad =
          std::hypot(noise.bearing_sigma_rad, noise.across_sigma_m / d);
      const bool is_wrong = std::uniform_real_distribution<double>()(rng_) < wrong_ids;
      frames[r].push_back(
          {now - from_seconds(0.03), is_wrong ? 100 + (id + 5) % 12 : id,
           expected.range_m + range_sigma_m * normal(),
           wrap_to_pi(expected.bearing_rad + shared_rad + bearing_sigma_rad * normal())});
    };
    for (const scenario::LandmarkSpec& landmark : landmarks) {
      add(landmark.id, landmark.position_m);
    }
    for (std::size_t other = 0; other < truth.size(); ++other) {
      if (other != r) {
        add(spec.robots[other].id, truth[other].position_m());
      }
    }
  }

  std::mt19937 rng_;
  std::vector<localizer::CommandedMotion> motions_;
  std::vector<double> turn_error_radps_;
  std::vector<double> speed_error_;
};

}  // namespace vantage::test
