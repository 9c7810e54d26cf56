#include "trial/simulated_camera.hpp"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "drivers/camera/tag_detector.hpp"
#include "scenario/reader/overrides.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "trial/recipe.hpp"
#include "trial/robot_processes.hpp"
#include "trial/trial.hpp"

namespace vantage::trial {
namespace {

scenario::Scenario camera_lab(double duration_s, const std::string& source = "") {
  scenario::Overrides overrides;
  overrides.duration_s = duration_s;
  overrides.node_budget = 500;
  if (!source.empty()) {
    overrides.keys["robot_defaults.sensor.camera.source"] = source;
  }
  return scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/lab-camera.yaml", overrides);
}

class SimulatedCamera : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto detector = drivers::camera::make_tag_detector("tag36h11"); !detector.ok()) {
      GTEST_SKIP() << detector.error().message;
    }
  }
};

// Tests the nodes of a flight from rendered images to beliefs. A consistent filter has NEES 2; with
// 40 s of five targets the mean of a consistent filter is within 1 and 3 for nearly all seeds.
TEST_F(SimulatedCamera, FindsAndTracksRoversByTheirTags) {
  const scenario::Scenario scenario = camera_lab(40.0);
  require_own_processes(scenario);
  const logs::TrialSummary summary = run_trial(scenario, trial_recipes(scenario)).summary;
  EXPECT_EQ(summary.discovered, 5);
  ASSERT_TRUE(summary.position_nees);
  EXPECT_GT(*summary.position_nees, 1.0);
  EXPECT_LT(*summary.position_nees, 3.0);
  EXPECT_EQ(summary.collisions, 0);
}

TEST_F(SimulatedCamera, GivesTheSameTrialForTheSameSeed) {
  const scenario::Scenario scenario = camera_lab(4.0);
  EXPECT_EQ(logs::to_json(run_trial(scenario, trial_recipes(scenario)).summary).dump(),
            logs::to_json(run_trial(scenario, trial_recipes(scenario)).summary).dump());
}

// HEALTH_<name> may contain only letters, digits and underscores.
TEST(SimulatedCameraRecipes, HaveNamesThatAreValidInChannels) {
  EXPECT_EQ(node_name(process_name("camera-emulator", "Q1")), "CAMERA_EMULATOR_Q1");
}

TEST(SimulatedCameraRecipes, ReplaceTheSensors) {
  const scenario::Scenario scenario = camera_lab(4.0);
  int cameras = 0;
  for (const NodeRecipe& recipe : trial_recipes(scenario)) {
    cameras += recipe.name.starts_with("CAMERA_") ? 1 : 0;
    EXPECT_FALSE(recipe.name.starts_with("SENSOR_"));
  }
  EXPECT_EQ(cameras, 3);
}

TEST(SimulatedCameraRecipes, RefuseOtherSourcesOfImages) {
  try {
    require_own_processes(camera_lab(4.0, "folder:images"));
    FAIL() << "accepted";
  } catch (const StartupError& error) {
    EXPECT_NE(std::string(error.what()).find("camera of Q1 has the source folder:images"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace vantage::trial
