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
#include "estimator/occupancy/team_map.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Bus interface of a TeamMap. Inputs are SCAN_R and the teammates' MAP_*; MAP_R is published once
/// after each BELIEF_R. Each MAP_R names its inputs: the belief, this robot's previous map, the
/// scans and the teammates' maps. The message can be reproduced from these inputs alone.
class MapPublisher {
 public:
  MapPublisher(bus::Bus& bus, const scenario::Scenario& scenario, const std::string& robot);

  /// Publishes the map of the step that produced `belief`. Precondition: `belief` has the stamp
  /// with which this bus published it.
  void step(const models::RobotBelief& belief);
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  /// Maximum number of runs kept per teammate's estimator; those with the newest maps are kept.
  static constexpr std::ptrdiff_t kRunsKept = 16;
  using Run = std::pair<std::string, std::int64_t>;  ///< robot and run id of its estimator

  /// Copies to in_range_ the newest maps that were sent by teammates in range.
  void update_in_range(const models::RobotBelief& belief);

  bus::Bus& bus_;
  std::string robot_;
  TeamMap map_;
  std::deque<NamedMessage<models::RangeScan>> scans_;             ///< scans not used in a step yet
  std::map<std::string, NamedMessage<models::RobotMap>> newest_;  ///< newest map of each teammate
  std::map<Run, NamedMessage<models::RobotMap>>
      in_range_;  ///< newest map of a teammate in range, by run of its estimator
  std::optional<NamedMessage<models::RobotMap>> own_;
  std::int64_t scans_overflowed_ = 0;
  std::int64_t misaddressed_ = 0;
  std::int64_t runs_forgotten_ = 0;
};

/// Replayer of logged maps: recomputes each MAP_R from the inputs that it names and publishes it
/// under the bus's prefix.
class MapReplayer {
 public:
  MapReplayer(bus::Bus& bus, const scenario::Scenario& scenario, const std::string& robot);

  void tick();
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  void work();
  /// Recomputes one map. Returns false while an input is missing.
  bool recompute(const models::RobotMap& logged);

  bus::Bus& bus_;
  std::string robot_;
  TeamMap map_;
  bus::InputStore<models::RobotBelief> beliefs_{64};
  bus::InputStore<models::RangeScan> scans_{256};
  bus::InputStore<models::RobotMap> maps_;
  /// Teammates' maps used by the previous step, stored because the log may reference them again
  /// long after their reception.
  std::vector<std::pair<models::InputRef, models::RobotMap>> previous_maps_;
  bus::ReplayQueue<models::RobotMap> logged_;  ///< maps not recomputed yet
  std::int64_t incomplete_ = 0;
};

}  // namespace vantage::estimator
