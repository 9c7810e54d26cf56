#include "sim/vicon/app/source.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::sim::vicon {
namespace {

constexpr double kCircleSpacing_m = 2.0;
constexpr int kCirclesPerRow = 10;

}  // namespace

bool CirclingBodies::fill(double time_s, EmulatedFrame& frame) {
  frame.bodies.resize(static_cast<std::size_t>(count_));
  for (int i = 0; i < count_; ++i) {
    const double angle_rad = time_s + i;
    EmulatedBody& body = frame.bodies[index(i)];
    body.name = "BODY" + std::to_string(i);
    const Eigen::Vector2d centre_m(kCircleSpacing_m * (i % kCirclesPerRow),
                                   kCircleSpacing_m * std::floor(i / kCirclesPerRow));
    body.world_from_body = lift({centre_m.x() + 0.5 * std::cos(angle_rad),
                                 centre_m.y() + 0.5 * std::sin(angle_rad), angle_rad},
                                1.0 + 0.1 * std::sin(0.3 * angle_rad));
    body.is_occluded = false;
  }
  return true;
}

Flights::Flights(const std::vector<std::string>& paths, bool is_endless) : is_endless_(is_endless) {
  for (const std::string& path : paths) {
    flights_.push_back(read_flight(path));
    const RecordedFlight& flight = flights_.back();
    const double length_s = static_cast<double>(flight.world_from_body.size()) * flight.period_s;
    length_s_ = flights_.size() == 1 ? length_s : std::min(length_s_, length_s);
  }
  if (flights_.empty()) {
    throw StartupError("no flight given");
  }
}

bool Flights::fill(double time_s, EmulatedFrame& frame) {
  if (time_s >= length_s_ && !is_endless_) {
    return false;
  }
  // Adds 1 ns, because rounding could select the previous row.
  const double at_s = std::fmod(time_s, length_s_) + 1e-9;
  frame.bodies.resize(flights_.size());
  for (std::size_t i = 0; i < flights_.size(); ++i) {
    const auto row = static_cast<std::size_t>(at_s / flights_[i].period_s);
    const std::size_t last = flights_[i].world_from_body.size() - 1;
    frame.bodies[i] = {flights_[i].name, flights_[i].world_from_body[std::min(row, last)], false};
  }
  return true;
}

ScenarioWorld::ScenarioWorld(const scenario::Scenario& scenario, Time start)
    : world_(scenario, scenario.seed, start), start_(start) {}

bool ScenarioWorld::fill(double time_s, EmulatedFrame& frame) {
  world_.advance_to(start_ + from_seconds(time_s));
  frame.bodies.clear();
  for (const models::MocapBody& body : world_.capture().bodies) {
    frame.bodies.push_back({body.name, body.world_from_body, body.occluded});
  }
  return true;
}

}  // namespace vantage::sim::vicon
