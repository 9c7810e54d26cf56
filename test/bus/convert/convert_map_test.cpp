#include <limits>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "test/bus/convert/sample_messages.hpp"

namespace vantage::bus {
namespace {

namespace wire = vantage_lcm;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// One change that makes a message invalid, and the reason.
template <class Wire>
struct Spoil {
  const char* what;
  void (*change)(Wire&);
};

template <class Wire, std::size_t N>
void expect_refused(const Wire& good, const Spoil<Wire> (&spoils)[N]) {
  ASSERT_TRUE(from_wire(good).has_value());
  for (const Spoil<Wire>& spoil : spoils) {
    Wire bad = good;
    spoil.change(bad);
    EXPECT_FALSE(from_wire(bad).has_value()) << spoil.what;
  }
}

TEST(FromWireScan, RefusesInvalidValues) {
  test::Sampler sampler(5201);
  auto scan = test::sample<models::RangeScan>(sampler);
  scan.jammed = false;
  scan.ranges_m = {0.5, 1.5};
  const Spoil<wire::scan_t> spoils[] = {
      {"NaN range", [](wire::scan_t& w) { w.range_m[1] = kNan; }},
      {"count above the beams", [](wire::scan_t& w) { ++w.num_beams; }},
      {"beams of a jammed scanner", [](wire::scan_t& w) { w.jammed = 1; }},
      {"boolean 2", [](wire::scan_t& w) { w.jammed = 2; }},
      {"no field of view", [](wire::scan_t& w) { w.field_of_view_rad = 0.0; }},
      {"more than a turn", [](wire::scan_t& w) { w.field_of_view_rad = 6.3; }},
      {"no range", [](wire::scan_t& w) { w.range_max_m = 0.0; }},
      {"NaN pose", [](wire::scan_t& w) { w.x_world_m = kNan; }},
      {"not UTF-8", [](wire::scan_t& w) { w.robot = "\xC3("; }},
  };
  expect_refused(to_wire(scan), spoils);
  scan.jammed = true;
  scan.ranges_m.clear();
  EXPECT_TRUE(from_wire(to_wire(scan)).has_value()) << "a jammed scan has no beams";
}

TEST(FromWireMap, RefusesInvalidValues) {
  test::Sampler sampler(5202);
  const Spoil<wire::map_t> spoils[] = {
      {"a cell too few", [](wire::map_t& w) { w.own_looks.pop_back(); }},
      {"a team's cell too few", [](wire::map_t& w) { w.team_looks.pop_back(); }},
      {"another number of rows", [](wire::map_t& w) { ++w.grid_rows; }},
      {"no resolution", [](wire::map_t& w) { w.grid_resolution_m = 0.0; }},
      {"NaN origin", [](wire::map_t& w) { w.grid_origin_y_m = kNan; }},
      {"negative entropy", [](wire::map_t& w) { w.entropy_nat = -1.0; }},
      {"negative step", [](wire::map_t& w) { w.step = -1; }},
      {"more inputs than there are", [](wire::map_t& w) { ++w.num_inputs; }},
  };
  expect_refused(to_wire(test::sample<models::RobotMap>(sampler)), spoils);
}

TEST(ToWireMap, LargestMapFitsTheSocketBuffer) {
  models::RobotMap map;
  map.grid = {{0.0, 0.0}, 0.2, 250, 200};
  map.own_looks.assign(50'000, -3);
  map.team_looks = map.own_looks;
  EXPECT_LE(to_wire(map).getEncodedSize(), 212'992) << "default value of rmem_max in Linux";
}

}  // namespace
}  // namespace vantage::bus
