#pragma once

#include <string>
#include <vector>

#include "core/pose.hpp"

namespace vantage::sim::vicon {

/// Recorded flight: one pose per `period_s`.
struct RecordedFlight {
  std::string name;  ///< name of the body: the file name without extension
  double period_s = 0.01;
  std::vector<Pose3> world_from_body;
};

/// Reads a table "time_s,x_m,y_m,z_m,qw,qx,qy,qz" with one header line and constant time steps.
/// @throws StartupError with file and line if the file is not such a table.
RecordedFlight read_flight(const std::string& path);

}  // namespace vantage::sim::vicon
