#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"

namespace vantage::logs {

/// Recording of the UTIAS Multi-Robot Cooperative Localization and Mapping data set, as read from
/// its folder. Subjects are robots (1 to 5) and landmarks (6 and above).
/// Source: K. Leung et al., "The UTIAS multi-robot cooperative localization and mapping dataset",
/// IJRR 30(8), 2011.
struct MrclamData {
  struct Landmark {
    int subject = 0;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  };
  struct Command {
    Time time{};
    double speed_mps = 0.0;
    double turn_radps = 0.0;
  };
  struct Observation {
    Time time{};
    int subject = 0;  ///< −1: the bar code is unknown
    double range_m = 0.0;
    double bearing_rad = 0.0;
  };
  struct TruePose {
    Time time{};
    Pose2 world_from_body;
  };
  struct Robot {
    int subject = 0;
    std::vector<Command> commands;  ///< each list is ascending in time
    std::vector<Observation> observations;
    std::vector<TruePose> truth;
  };
  std::vector<Landmark> landmarks;
  std::vector<Robot> robots;
  std::int64_t reordered = 0;   ///< lines with a time before that of the previous line; sorted
  std::int64_t impossible = 0;  ///< observations with an impossible range or bearing; left out
};

/// Reads the files Barcodes.dat, Landmark_Groundtruth.dat, RobotN_Odometry.dat,
/// RobotN_Measurement.dat and RobotN_Groundtruth.dat for N = 1, 2, …
/// @throws StartupError with file, line, value and rule if a file is missing, empty, or has an
/// invalid line
MrclamData read_mrclam(const std::string& folder);

}  // namespace vantage::logs
