#include "bus/convert/convert_parts.hpp"

// Scans and maps of robots: SCAN_R and MAP_R.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

vantage_lcm::scan_t to_wire(const models::RangeScan& scan) {
  auto wire = stamped<vantage_lcm::scan_t>(scan.stamp);
  wire.robot = scan.robot;
  viewpoint_to(scan.viewpoint, wire);
  wire.jammed = scan.jammed ? 1 : 0;
  wire.field_of_view_rad = scan.field_of_view_rad;
  wire.range_max_m = scan.range_max_m;
  wire.num_beams = count_of(scan.ranges_m.size());
  wire.range_m = scan.ranges_m;
  inputs_to(scan.inputs, wire);
  return wire;
}

std::optional<models::RangeScan> from_wire(const vantage_lcm::scan_t& wire) {
  constexpr double kFullCircleRad = 2.0 * kPi + 1e-9;
  const auto stamp = stamp_from(wire);
  const auto viewpoint = viewpoint_from(wire);
  auto inputs = inputs_from(wire);
  if (!stamp || !viewpoint || !inputs || !is_text(wire.robot) || !is_boolean(wire.jammed) ||
      !is_count(wire.num_beams, wire.range_m.size()) ||
      !are_finite(wire.field_of_view_rad, wire.range_max_m) || wire.range_max_m <= 0.0 ||
      wire.field_of_view_rad <= 0.0 || wire.field_of_view_rad > kFullCircleRad ||
      (wire.jammed != 0 && wire.num_beams != 0)) {
    return std::nullopt;
  }
  for (const double range_m : wire.range_m) {
    if (!are_finite(range_m)) {
      return std::nullopt;
    }
  }
  return models::RangeScan{
      *stamp,           wire.robot,   *viewpoint,        wire.jammed != 0, wire.field_of_view_rad,
      wire.range_max_m, wire.range_m, std::move(*inputs)};
}

vantage_lcm::map_t to_wire(const models::RobotMap& map) {
  auto wire = with_step_head<vantage_lcm::map_t>(map, map.own_looks.size());
  wire.own_looks = map.own_looks;
  wire.team_looks = map.team_looks;
  wire.team_looks.resize(map.own_looks.size());
  wire.entropy_nat = map.entropy_nats;
  return wire;
}

std::optional<models::RobotMap> from_wire(const vantage_lcm::map_t& wire) {
  auto head = step_head_from(wire, wire.own_looks.size());
  if (!head || wire.team_looks.size() != wire.own_looks.size() || !are_finite(wire.entropy_nat) ||
      wire.entropy_nat < 0.0) {
    return std::nullopt;
  }
  return models::RobotMap{head->stamp,     wire.robot,       wire.step,
                          head->viewpoint, head->grid,       wire.own_looks,
                          wire.team_looks, wire.entropy_nat, std::move(head->inputs)};
}

}  // namespace vantage::bus
