#include "drivers/sensor/range_scanner.hpp"

#include "drivers/sensor/pose_sensor.hpp"
#include "models/mapping/beam_scan.hpp"

namespace vantage::drivers {

RangeScanner::RangeScanner(const scenario::Scenario& scenario, const std::string& robot)
    : robot_(robot),
      world_(scenario.world),
      scanner_(scenario.mapping.scanner),
      seed_(scenario.seed) {
  models::require_valid(scanner_);
}

models::RangeScan RangeScanner::scan(Time time, const models::Viewpoint& viewpoint,
                                     bool jammed) const {
  models::RangeScan scan;
  scan.stamp.time = time;
  scan.robot = robot_;
  scan.viewpoint = viewpoint;
  scan.jammed = jammed;
  scan.field_of_view_rad = scanner_.field_of_view_rad;
  scan.range_max_m = scanner_.range_max_m;
  if (!jammed) {
    std::mt19937_64 noise = noise_of(seed_, robot_, kScanStream, time);
    scan.ranges_m = models::beam_scan(world_, scanner_, viewpoint.world_from_body, noise);
  }
  return scan;
}

}  // namespace vantage::drivers
