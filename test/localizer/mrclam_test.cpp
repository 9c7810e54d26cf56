#include "logs/mrclam/mrclam.hpp"

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "localizer/fit/sensor_fit.hpp"
#include "localizer/judge/judge.hpp"
#include "tools/log/team_recording.hpp"

// Figures of the localisers on set 6 of the MRCLAM data set, whose folder is in VANTAGE_MRCLAM.

namespace vantage::localizer {
namespace {

/// Set 6 with the fitted parameters; read and fitted once.
class MrclamSetSix : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const char* const folder = std::getenv("VANTAGE_MRCLAM");
    if (folder == nullptr) {
      return;
    }
    trial_ =
        std::make_unique<tools::TeamRecording>(tools::team_of(logs::read_mrclam(folder), folder));
    for (std::size_t robot = 0; robot < trial_->recording.size(); ++robot) {
      sensors_.push_back(fit_sensor(trial_->spec.landmarks, trial_->recording[robot]));
      drives_.push_back(fit_drive(trial_->recording[robot]));
      trial_->spec.robots[robot].sightings = sensors_.back().sensor;
      trial_->spec.robots[robot].drive = drives_.back().drive;
      const scenario::SightingSpec& s = sensors_.back().sensor;
      const scenario::DriveSpec& d = drives_.back().drive;
      std::printf(
          "robot %zu: scale %.4f offset %.4f axis %.4f bearing %.4f forward %.4f stamp %.4f "
          "loss %.2f of distance %.2f sigma %.4f %.5f %.4f outliers %.4f detected %.2f; delay %.4f "
          "lag %.4f speed %.4f turn %.4f bias %.4f\n",
          robot + 1, s.range_scale, s.range_offset_m, s.axis_rad, s.bearing_offset_rad, s.forward_m,
          s.stamp_delay_s, sensors_.back().depth_loss, sensors_.back().distance_loss,
          sensors_.back().range_sigma_m, sensors_.back().range_sigma_per_m,
          sensors_.back().bearing_sigma_rad, sensors_.back().outliers,
          sensors_.back().detection_probability, d.delay_s, d.lag_s, d.speed_scale, d.turn_scale,
          d.turn_bias_radps);
    }
  }
  static void TearDownTestSuite() { trial_.reset(); }
  void SetUp() override {
    if (trial_ == nullptr) {
      GTEST_SKIP() << "set VANTAGE_MRCLAM to the folder MRCLAM_Dataset6";
    }
  }
  [[nodiscard]] static JudgeFigures run(const JudgeOptions& options) {
    // The recorded true heading of robot 1 has errors of up to 0.1 rad.
    const JudgeFigures figures =
        judge(trial_->spec, trial_->recording, options, {false, true, true, true, true});
    std::printf(
        "position: RMSE %.4f median %.4f p95 %.4f max %.3f m; yaw %.4f rad; NEES %.2f of 2 "
        "(%.3f inside), %.2f of 3 (%.3f inside); %.0f bytes/s; without pose %d\n  robots",
        figures.position_m.rmse, figures.position_m.median, figures.position_m.p95,
        figures.position_m.max, figures.yaw_rad.rmse, figures.nees_position,
        figures.inside_position, figures.nees_pose, figures.inside_pose, figures.bytes_per_robot_s,
        figures.without_pose);
    for (std::size_t robot = 0; robot < figures.robot_position_m.size(); ++robot) {
      std::printf(" %.4f (placed after %.1f s)", figures.robot_position_m[robot].rmse,
                  figures.placed_after_s[robot]);
    }
    std::printf("\n");
    return figures;
  }

  static inline std::unique_ptr<tools::TeamRecording> trial_;
  static inline std::vector<SensorFit> sensors_;
  static inline std::vector<DriveFit> drives_;
};

TEST_F(MrclamSetSix, FindsDepthModelAndDelays) {
  double stamp_delay_s = 0.0;
  double forward_max_m = 0.0;
  double response_s = 0.0;
  for (std::size_t robot = 0; robot < sensors_.size(); ++robot) {
    const SensorFit& sensor = sensors_[robot];
    EXPECT_TRUE(sensor.sensor.range_is_depth) << robot;
    EXPECT_LT(sensor.depth_loss, 0.8 * sensor.distance_loss) << robot;
    EXPECT_GT(sensor.sensor.range_scale, 1.008) << robot;
    EXPECT_LT(sensor.sensor.range_scale, 1.06) << robot;
    stamp_delay_s += sensor.sensor.stamp_delay_s / 5.0;
    forward_max_m = std::max(forward_max_m, sensor.sensor.forward_m);
    // The delay and the lag of one robot can replace each other; their sum is determined.
    response_s += (drives_[robot].drive.delay_s + drives_[robot].drive.lag_s) / 5.0;
    EXPECT_GT(drives_[robot].drive.turn_scale, 0.92) << robot;
    EXPECT_LT(drives_[robot].drive.turn_scale, 1.0) << robot;
  }
  EXPECT_NEAR(stamp_delay_s, 0.037, 0.2 * 0.037);
  EXPECT_NEAR(forward_max_m, 0.11, 0.2 * 0.11);
  EXPECT_NEAR(response_s, 0.247, 0.2 * 0.247);
}

TEST_F(MrclamSetSix, EstimatesPositionsWithKnownStart) {
  const JudgeFigures figures = run({});
  EXPECT_LT(figures.position_m.rmse, 0.072);
  EXPECT_LT(figures.yaw_rad.rmse, 0.066);
  EXPECT_GT(figures.nees_position, 1.7);
  EXPECT_LT(figures.nees_position, 2.4);
}

TEST_F(MrclamSetSix, EstimatesPositionsWhenMessagesAreLost) {
  EXPECT_LT(run({.loss = 0.2}).position_m.rmse, 0.073);
}

TEST_F(MrclamSetSix, EstimatesPositionsWithUnknownStart) {
  const JudgeFigures figures = run({.is_start_known = false});
  EXPECT_EQ(figures.without_pose, 0);
  EXPECT_LT(figures.position_m.rmse, 0.075);
}

TEST_F(MrclamSetSix, ImprovesWithHindsight) {
  const JudgeFigures late = run({.hindsight_s = 20.0});
  EXPECT_LT(late.position_m.rmse, 0.045);
  const JudgeFigures smoothed = run({.hindsight_s = std::numeric_limits<double>::infinity()});
  EXPECT_LT(smoothed.position_m.rmse, 0.038);
}

}  // namespace
}  // namespace vantage::localizer
