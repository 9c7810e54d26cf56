#include "scenario/reader/camera_yaml.hpp"

#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/lab_text.hpp"

namespace vantage::scenario {
namespace {

constexpr const char* kRosCalibration =
    "image_width: 640\n"
    "image_height: 480\n"
    "camera_name: left\n"
    "camera_matrix:\n"
    "  rows: 3\n"
    "  cols: 3\n"
    "  data: [420.5, 0, 321.0, 0, 421.5, 238.0, 0, 0, 1]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n"
    "  rows: 1\n"
    "  cols: 5\n"
    "  data: [-0.28, 0.07, 0.0003, -0.0002, 0.01]\n"
    "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n";

constexpr const char* kOpenCvCalibration =
    "%YAML:1.0\n"
    "---\n"
    "calibration_time: \"Sun Nov 29 2026\"\n"
    "image_width: 640\n"
    "image_height: 480\n"
    "camera_matrix: !!opencv-matrix\n"
    "   rows: 3\n"
    "   cols: 3\n"
    "   dt: d\n"
    "   data: [ 4.205e+02, 0., 3.21e+02, 0., 4.215e+02, 2.38e+02, 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n"
    "   rows: 5\n"
    "   cols: 1\n"
    "   dt: d\n"
    "   data: [ -2.8e-01, 7.0e-02, 3.0e-04, -2.0e-04, 1.0e-02 ]\n";

TEST(Calibration, IsReadInTheFormatsOfRosAndOpenCv) {
  for (const char* text : {kRosCalibration, kOpenCvCalibration}) {
    const models::CameraModel camera = parse_calibration(text, "left.yaml");
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.height, 480);
    EXPECT_EQ(camera.focal_x_pixels, 420.5);
    EXPECT_EQ(camera.focal_y_pixels, 421.5);
    EXPECT_EQ(camera.center_x_pixels, 321.0);
    EXPECT_EQ(camera.center_y_pixels, 238.0);
    EXPECT_EQ(camera.distortion, (std::array<double, 5>{-0.28, 0.07, 0.0003, -0.0002, 0.01}));
  }
}

struct RefusalRow {
  const char* was;
  const char* becomes;
  const char* error;  ///< part of the message, with the line
};

TEST(Calibration, IsRefusedWithTheLineOfTheMistake) {
  for (const RefusalRow& row : {
           RefusalRow{"640", "-1", "left.yaml:1: image_width"},
           RefusalRow{"640", "1000000", "left.yaml:1: image_width"},
           RefusalRow{"640", "320", "left.yaml:4: camera_matrix: the principal point (321, 238)"},
           RefusalRow{"420.5", ".nan", "left.yaml:7: camera_matrix.data"},
           RefusalRow{"420.5", "1e300", "left.yaml:7: camera_matrix.data"},
           RefusalRow{"420.5", "0.5", "left.yaml:4: camera_matrix: fx and fy"},
           RefusalRow{"420.5, 0,", "420.5, 3,", "must have the form [fx, 0, cx"},
           RefusalRow{"420.5, 0,", "420.5,", "rows · cols = 9 numbers, contains 8"},
           RefusalRow{"  rows: 3\n", "  rows: 3000\n", "left.yaml:5: camera_matrix.rows"},
           RefusalRow{"plumb_bob", "equidistant", "left.yaml:8: distortion_model"},
           RefusalRow{"-0.28", "-2.8",
                      "left.yaml:9: distortion_coefficients: the coefficients fold"},
           RefusalRow{"-0.28", "5000", "left.yaml:9: distortion_coefficients: each coefficient"},
           RefusalRow{"camera_matrix:\n", "matrix:\n", "camera_matrix"},
           RefusalRow{"camera_name: left", "camera_name: \t", "left.yaml:3"},
       }) {
    std::string text = kRosCalibration;
    const std::size_t at = text.find(row.was);
    ASSERT_NE(at, std::string::npos) << row.was;
    text.replace(at, std::string(row.was).size(), row.becomes);
    try {
      static_cast<void>(parse_calibration(text, "left.yaml"));
      ADD_FAILURE() << "accepted: " << row.becomes;
    } catch (const StartupError& error) {
      EXPECT_NE(std::string(error.what()).find(row.error), std::string::npos) << error.what();
    }
  }
}

/// Returns config/lab.yaml with cameras instead of sensors; `edits` change it.
std::string camera_text(std::vector<test::TextEdit> edits = {}) {
  std::vector<test::TextEdit> all = {
      {"  sensor:",
       "  sensor:\n"
       "    device: camera\n"
       "    camera:\n"
       "      source: folder:images\n"
       "      calibration: left.yaml\n"
       "      body_from_camera: {x_m: 0.1, z_m: -0.05, tilt_deg: 90}\n"
       "      tags:\n"
       "        - {id: 7, target: R2, size_m: 0.2}\n"
       "        - {id: 8, landmark: 6, size_m: 0.3}\n"
       "        - {id: 9, robot: Q2, size_m: 0.1}\n"
       "    #"},
      {"seed: 1 ",
       "localizer: {landmarks: [{id: 6, x_m: 1, y_m: 1}], robots: [{name: Q2, id: 2}]}\n"
       "seed: 1 "}};
  all.insert(all.end(), edits.begin(), edits.end());
  return test::lab_with(all);
}

TEST(CamerasOf, ReadsTheCameraOfEachRobot) {
  const Scenario scenario = parse_scenario(camera_text(), "lab.yaml");
  EXPECT_EQ(scenario.robots[0].sensor_publisher, Publisher::kExternal);
  const std::vector<CameraSpec> cameras = cameras_of(scenario);
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_EQ(cameras[1].robot, "Q2");
  EXPECT_EQ(cameras[1].source, "folder:images");
  EXPECT_EQ(cameras[1].calibration_file, "left.yaml");
  ASSERT_EQ(cameras[1].tags.size(), 3U);
  EXPECT_EQ(cameras[1].tags[0].carrier, TagCarrier::kTarget);
  EXPECT_EQ(cameras[1].tags[0].body_id, 1);
  EXPECT_EQ(cameras[1].tags[1].carrier, TagCarrier::kLandmark);
  EXPECT_EQ(cameras[1].tags[1].body_id, 6);
  EXPECT_EQ(cameras[1].tags[2].carrier, TagCarrier::kRobot);
  EXPECT_EQ(cameras[1].tags[2].body_id, 2);
  EXPECT_TRUE(camera_of(scenario, "Q3"));
  EXPECT_FALSE(camera_of(scenario, "Q4"));
}

// A camera that looks down has its axis along −z of the body; the image's upper side is forward.
TEST(CamerasOf, TiltsTheCameraDownwards) {
  const Pose3 body_from_camera =
      camera_of(parse_scenario(camera_text(), "lab.yaml"), "Q1")->body_from_camera;
  const Eigen::Vector3d axis = body_from_camera.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up = body_from_camera.rotation * -Eigen::Vector3d::UnitY();
  EXPECT_NEAR((axis - Eigen::Vector3d(0.0, 0.0, -1.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((up - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((body_from_camera.translation_m - Eigen::Vector3d(0.1, 0.0, -0.05)).norm(), 0.0,
              1e-12);
}

TEST(CamerasOf, IsEmptyWithoutCameras) {
  EXPECT_TRUE(cameras_of(parse_scenario(test::lab_with({}), "lab.yaml")).empty());
  EXPECT_TRUE(cameras_of(Scenario{}).empty());
}

TEST(CamerasOf, RefusesMistakesWithTheirLine) {
  for (const RefusalRow& row : {
           RefusalRow{"target: R2", "target: R9", "tags[0]: target must be the name of a target"},
           RefusalRow{"landmark: 6", "landmark: 5", "tags[1]: landmark must be the id of one of"},
           RefusalRow{"robot: Q2, size", "robot: Q1, size", "tags[2]: robot must be the name"},
           RefusalRow{"id: 8", "id: 7", "tags[1]: id must be unique"},
           RefusalRow{"target: R2, ", "", "must have exactly one of target, landmark and robot"},
           RefusalRow{"folder:images", "rtsp:camera", "source: must be folder:PATH"},
           RefusalRow{"folder:images", "'folder:'", "source: must be folder:PATH"},
           RefusalRow{"size_m: 0.2}", "size_m: 0}", "tags[0].size_m"},
           RefusalRow{"    camera:\n", "    camera2:\n", "camera2"},
           RefusalRow{"tilt_deg: 90", "tilt_deg: 95", "body_from_camera.tilt_deg"},
       }) {
    try {
      static_cast<void>(parse_scenario(camera_text({{row.was, row.becomes}}), "lab.yaml"));
      ADD_FAILURE() << "accepted: " << row.becomes;
    } catch (const StartupError& error) {
      EXPECT_NE(std::string(error.what()).find(row.error), std::string::npos) << error.what();
    }
  }
}

// A camera measures positions of identified targets: no velocities, no unknown targets, no ranges
// of obstacles.
TEST(CamerasOf, RefusesSensorsThatImagesCannotReplace) {
  for (const RefusalRow& row : {
           RefusalRow{"kind: range_bearing", "kind: range_rate", "kind must be one without veloc"},
           RefusalRow{"detects_ids: true", "detects_ids: false", "detects_ids must be true with"},
       }) {
    try {
      static_cast<void>(parse_scenario(camera_text({{row.was, row.becomes}}), "lab.yaml"));
      ADD_FAILURE() << "accepted: " << row.becomes;
    } catch (const StartupError& error) {
      EXPECT_NE(std::string(error.what()).find(row.error), std::string::npos) << error.what();
    }
  }
}

TEST(CamerasOf, RefusesTwoDetectorsOfOneRobot) {
  const std::string both =
      camera_text({{"seed: 1 ", "ros2: {detections: [{topic: /Q1/d, robot: Q1}]}\nseed: 1 "}});
  EXPECT_THROW(static_cast<void>(parse_scenario(both, "lab.yaml")), StartupError);
}

}  // namespace
}  // namespace vantage::scenario
