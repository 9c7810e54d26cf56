#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/input_store.hpp"
#include "bus/node/replay_queue.hpp"
#include "core/time.hpp"
#include "estimator/app/step_material.hpp"
#include "estimator/team_map.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// The map's part of an estimator on the bus: SCAN_R and the teammates' MAP_* in, MAP_R out, once
/// after each BELIEF_R. Each message names the belief, the own map before, the scans and the
/// teammates' maps that it stands on, so that it can be made again from these alone.
class MapPublisher {
 public:
  MapPublisher(bus::Bus& bus, const scenario::Scenario& scenario, const std::string& robot);

  /// `belief` as it was published under `name`.
  void step(const models::RobotBelief& belief, const models::InputRef& name);
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  /// Runs of one teammate's estimator that are remembered: of more, those with the newest maps.
  static constexpr std::ptrdiff_t kRunsKept = 16;
  using Run = std::pair<std::string, std::int64_t>;  ///< a robot, and a run of its estimator

  /// Takes up what was heard in range.
  void take_up(const models::RobotBelief& belief);

  bus::Bus& bus_;
  std::string robot_;
  TeamMap map_;
  std::deque<Heard<models::RangeScan>> scans_;             ///< not counted yet
  std::map<std::string, Heard<models::RobotMap>> newest_;  ///< by teammate, in range or not
  std::map<Run, Heard<models::RobotMap>> taken_;           ///< newest in range of each run
  std::optional<Heard<models::RobotMap>> own_;
  std::int64_t scans_overflowed_ = 0;
  std::int64_t misaddressed_ = 0;
  std::int64_t runs_forgotten_ = 0;
};

/// Makes the logged MAP_R again, each from the inputs that it names, under the bus's prefix.
class MapReplayer {
 public:
  MapReplayer(bus::Bus& bus, const scenario::Scenario& scenario, const std::string& robot);

  void tick();
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  void work();
  /// False while an input is missing.
  bool redo(const models::RobotMap& logged);

  bus::Bus& bus_;
  std::string robot_;
  TeamMap map_;
  bus::InputStore<models::RobotBelief> beliefs_{64};
  bus::InputStore<models::RangeScan> scans_{256};
  bus::InputStore<models::RobotMap> maps_;
  /// What the step before stood on: it may be named long after it was heard.
  std::vector<std::pair<models::InputRef, models::RobotMap>> standing_;
  bus::ReplayQueue<models::RobotMap> logged_;  ///< not made again yet
  std::int64_t incomplete_ = 0;
};

}  // namespace vantage::estimator
