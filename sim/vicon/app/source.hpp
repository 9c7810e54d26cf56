#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "sim/vicon/emulated_frame.hpp"
#include "sim/vicon/recorded_flight.hpp"
#include "sim/world/world_simulation.hpp"

namespace vantage::sim::vicon {

/// Source of the poses that the emulated cameras capture.
class Source {
 public:
  Source() = default;
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  Source(Source&&) = delete;
  Source& operator=(Source&&) = delete;
  /// Sets the bodies of `frame` to those at `time_s` after the start. Returns false after the end
  /// of the source.
  virtual bool fill(double time_s, EmulatedFrame& frame) = 0;
};

/// Bodies BODY0, BODY1, …, each on a separate circle.
class CirclingBodies : public Source {
 public:
  explicit CirclingBodies(int count) : count_(count) {}
  bool fill(double time_s, EmulatedFrame& frame) override;

 private:
  int count_;
};

/// Recorded flights, all started at their first row. At each instant the newest row applies.
class Flights : public Source {
 public:
  /// @param is_endless  restarts all flights when the shortest one ends
  Flights(const std::vector<std::string>& paths, bool is_endless);
  bool fill(double time_s, EmulatedFrame& frame) override;

 private:
  std::vector<RecordedFlight> flights_;
  double length_s_ = 0.0;
  bool is_endless_;
};

/// World of a scenario without planners: robots hover, targets move.
class ScenarioWorld : public Source {
 public:
  ScenarioWorld(const scenario::Scenario& scenario, Time start);
  bool fill(double time_s, EmulatedFrame& frame) override;

 private:
  WorldSimulation world_;
  Time start_;
};

}  // namespace vantage::sim::vicon
