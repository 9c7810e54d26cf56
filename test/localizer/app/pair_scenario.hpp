#pragma once

namespace vantage::test {

/// Scenario of two robots with localizers and three landmarks. Robot A's sightings are stamped
/// late.
inline constexpr const char* kPairScenario = R"(
name: pair
world: {bounds: {min_m: [-5, -5], max_m: [5, 5]}}
targets: {count: 1}
robot_defaults: {primitives: lab, sensor: {kind: range}}
robots: [{name: A, start: {x_m: 0, y_m: 0}}, {name: B, start: {x_m: 2, y_m: 0}}]
localizer:
  landmarks: [{id: 10, x_m: 3, y_m: 1}, {id: 11, x_m: 3, y_m: -1}, {id: 12, x_m: -3, y_m: 0}]
  robots: [{name: A, id: 1, sightings: {stamp_delay_s: 0.03}}, {name: B, id: 2}]
)";

}  // namespace vantage::test
