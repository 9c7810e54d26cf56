#include "scenario/reader/localizer_text.hpp"

#include <fmt/format.h>

#include "core/angle.hpp"

namespace vantage::scenario {
namespace {

std::string line(int depth, const char* key, double value) {
  return fmt::format("{:{}}{}: {:.6g}\n", "", 2 * depth, key, value);
}

std::string robot_text(const LocalizedRobotSpec& robot) {
  const SightingSpec& s = robot.sightings;
  const DriveSpec& d = robot.drive;
  return fmt::format("    - name: {}\n      id: {}\n      sightings:\n", robot.name, robot.id) +
         fmt::format("        range_is_depth: {}\n", s.range_is_depth) +
         line(4, "range_scale", s.range_scale) + line(4, "range_offset_m", s.range_offset_m) +
         line(4, "axis_deg", degrees(s.axis_rad)) +
         line(4, "bearing_offset_deg", degrees(s.bearing_offset_rad)) +
         line(4, "forward_m", s.forward_m) + line(4, "stamp_delay_s", s.stamp_delay_s) +
         "      drive:\n" + line(4, "delay_s", d.delay_s) + line(4, "lag_s", d.lag_s) +
         line(4, "speed_scale", d.speed_scale) + line(4, "turn_scale", d.turn_scale) +
         line(4, "turn_bias_radps", d.turn_bias_radps);
}

}  // namespace

std::string localizer_text(const LocalizerSpec& spec) {
  std::string text = "localizer:\n";
  text += spec.landmarks.empty() ? "  landmarks: []\n" : "  landmarks:\n";
  for (const LandmarkSpec& landmark : spec.landmarks) {
    text += fmt::format("    - {{id: {}, x_m: {:.6f}, y_m: {:.6f}}}\n", landmark.id,
                        landmark.position_m.x(), landmark.position_m.y());
  }
  text += fmt::format("  unknown_landmarks_max: {}\n", spec.unknown_landmarks_max);
  text += "  robots:\n";
  for (const LocalizedRobotSpec& robot : spec.robots) {
    text += robot_text(robot);
  }
  const OdometryNoiseSpec& o = spec.odometry_noise;
  text += "  odometry_noise:\n" +
          line(2, "turn_sigma_rad_per_sqrt_s", o.turn_sigma_rad_per_sqrt_s) +
          line(2, "turn_sigma_per_sqrt_rad", o.turn_sigma_per_sqrt_rad) +
          line(2, "slide_sigma_per_sqrt_m", o.slide_sigma_per_sqrt_m) +
          line(2, "turn_drift_radps", o.turn_drift_radps) +
          line(2, "turn_drift_time_s", o.turn_drift_time_s) +
          line(2, "speed_drift_share", o.speed_drift_share) +
          line(2, "speed_drift_time_s", o.speed_drift_time_s);
  const SightingNoiseSpec& n = spec.sighting_noise;
  text += "  sighting_noise:\n" + line(2, "range_sigma_m", n.range_sigma_m) +
          line(2, "range_sigma_per_m", n.range_sigma_per_m) +
          line(2, "bearing_sigma_rad", n.bearing_sigma_rad) +
          line(2, "across_sigma_m", n.across_sigma_m) +
          line(2, "frame_bearing_sigma_rad", n.frame_bearing_sigma_rad) +
          line(2, "teammate_sigma_m", n.teammate_sigma_m);
  return text;
}

}  // namespace vantage::scenario
