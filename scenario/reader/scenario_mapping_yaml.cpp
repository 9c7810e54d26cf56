#include <fmt/format.h>

#include "scenario/reader/scenario_agents_yaml.hpp"
#include "scenario/reader/scenario_sections_yaml.hpp"

namespace vantage::scenario {
namespace {

using models::MappingSpec;

constexpr int kBeamsMax = 10'000;
/// Largest number of cells of a map. The MAP_R message then has 200 kB, about the usual size of a
/// socket buffer.
constexpr double kMapCellsMax = 50'000;

void read_scanner(Mapping& from, models::BeamSensor& scanner) {
  from.integer("beams", scanner.beams, 1, kBeamsMax);
  from.angle("fov", scanner.field_of_view_rad, above_to(0.0, 360.0));
  from.number("range_min_m", scanner.range_min_m, at_least(0.0));
  from.number("range_max_m", scanner.range_max_m, above_to(0.0, kLengthMaxM));
  from.number("range_sigma_m", scanner.sigma_m, above(0.0));
  if (scanner.range_min_m >= scanner.range_max_m) {
    from.refuse("range_min_m", fmt::format("must be below range_max_m ({}), but is {}",
                                           scanner.range_max_m, scanner.range_min_m));
  }
}

void read(Mapping& from, const models::World& world, MappingSpec& mapping) {
  from.section("scanner", [&](Mapping& scanner) { read_scanner(scanner, mapping.scanner); });
  from.integer("planned_beams", mapping.planned_beams, 1, kBeamsMax);
  from.number("resolution_m", mapping.resolution_m, above(0.0));
  constexpr Range kAboveEven{0.5, 1.0, true, true};
  from.number("look_probability", mapping.look_probability, kAboveEven);
  from.number("settled_probability", mapping.settled_probability, kAboveEven);
  from.number("frontier_nats_per_m", mapping.frontier_nats_per_m, at_least(0.0));
  const Eigen::Vector2d size_m = world.bounds.max_m - world.bounds.min_m;
  const double cells = (size_m / mapping.resolution_m).array().ceil().prod();
  if (cells > kMapCellsMax) {
    from.refuse("resolution_m",
                fmt::format("must divide world.bounds into at most {} cells; {} gives {:.3g}",
                            kMapCellsMax, mapping.resolution_m, cells));
  }
}

}  // namespace

void read_mapping_spec(Mapping& top, Scenario& scenario) {
  const bool is_there =
      top.section("mapping", [&](Mapping& from) { read(from, scenario.world, scenario.mapping); });
  if (!is_there && scenario.planner.objective == PlanObjective::kMapping) {
    top.refuse("planner",
               "objective: mapping needs the section `mapping`, which describes the scanners");
  }
}

}  // namespace vantage::scenario
