#include "estimator/occupancy/team_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"

namespace vantage::estimator {
namespace {

constexpr int kAgeMaxSteps = 3;

models::InverseBeamModel inverse_model(const models::MappingSpec& spec) {
  const double look_log_odds = models::log_odds_of(spec.look_probability);
  return {look_log_odds, -look_log_odds};
}

}  // namespace

std::vector<models::NamedCount> MapCounters::named() const {
  std::vector<models::NamedCount> all{{"map.jammed_scans", jammed_scans},
                                      {"map.malformed_scans", malformed_scans},
                                      {"map.malformed_maps", malformed_maps}};
  std::erase_if(all, [](const models::NamedCount& each) { return each.count == 0; });
  return all;
}

TeamMap::TeamMap(const scenario::Scenario& scenario, const std::string& robot)
    : robot_(robot),
      spec_(scenario.mapping),
      geometry_(models::map_geometry(scenario.world, spec_)),
      communication_range_m_(scenario.network.communication_range_m),
      age_max_(kAgeMaxSteps * from_seconds(scenario.planner.step_s)),
      fusion_(spec_.scanner, inverse_model(spec_)) {
  require(scenario.find_robot(robot) != nullptr, "the scenario has no robot '" + robot + "'");
}

bool TeamMap::is_of_this_grid(const models::RobotMap& theirs) {
  const bool is = theirs.grid == geometry_;
  counters_.malformed_maps += is ? 0 : 1;
  return is;
}

bool TeamMap::accepts(const models::RobotBelief& own, const models::RobotMap& theirs) const {
  const Duration age = own.stamp.time - theirs.stamp.time;
  return theirs.grid == geometry_ && age >= Duration{0} && age <= age_max_ &&
         distance_m(own.viewpoint, theirs.viewpoint) <= communication_range_m_;
}

void TeamMap::count(const models::RangeScan& scan, models::CellCounts& cell_counts) {
  if (scan.jammed) {
    ++counters_.jammed_scans;
    return;
  }
  const bool is_known = std::abs(scan.field_of_view_rad - spec_.scanner.field_of_view_rad) < 1e-9 &&
                        scan.range_max_m == spec_.scanner.range_max_m &&
                        scan.ranges_m.size() == static_cast<std::size_t>(spec_.scanner.beams) &&
                        geometry_.index_of(scan.viewpoint.world_from_body.position_m()) >= 0;
  if (!is_known) {
    ++counters_.malformed_scans;
    return;
  }
  fusion_.count(geometry_, scan.viewpoint.world_from_body, scan.ranges_m, cell_counts);
}

models::RobotMap TeamMap::step(const MapInput& input) {
  require(input.belief != nullptr, "a step of the map requires the belief of that step");
  models::RobotMap map;
  map.stamp.time = input.belief->stamp.time;
  map.robot = robot_;
  map.step = input.belief->step;
  map.viewpoint = input.belief->viewpoint;
  map.grid = geometry_;
  if (input.before != nullptr && input.before->grid == geometry_) {
    map.own_looks = input.before->own_looks;
  }
  map.own_looks.resize(static_cast<std::size_t>(geometry_.size()), 0);
  for (const models::RangeScan* scan : input.scans) {
    count(*scan, map.own_looks);
  }
  std::vector<std::span<const std::int16_t>> all{map.own_looks};
  for (const models::RobotMap* theirs : input.teammates) {
    if (is_of_this_grid(*theirs)) {
      all.emplace_back(theirs->own_looks);
    }
  }
  map.team_looks = models::sum_of(all);
  map.entropy_nats = models::belief_of(geometry_, map.team_looks, spec_).entropy_nats();
  return map;
}

}  // namespace vantage::estimator
