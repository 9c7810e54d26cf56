#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "bus/node/bus.hpp"
#include "core/time.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "logs/picture/scene.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::trial {

/// Observer of a complete trial on a bus: collects metrics and a scene for the display. Messages of
/// robots that are not in the scenario are ignored, so that the memory use is bounded. The bus must
/// outlive the observer; the owner of the bus calls its handle().
class TrialObserver {
 public:
  TrialObserver(bus::Bus& bus, const scenario::Scenario& scenario, Time start);
  TrialObserver(const TrialObserver&) = delete;
  TrialObserver& operator=(const TrialObserver&) = delete;
  TrialObserver(TrialObserver&&) = delete;
  TrialObserver& operator=(TrialObserver&&) = delete;
  ~TrialObserver() = default;

  [[nodiscard]] logs::TrialMetrics& metrics() { return metrics_; }
  [[nodiscard]] const logs::TrialMetrics& metrics() const { return metrics_; }
  /// These functions return the newest messages received; nullopt or empty before the first
  /// message.
  [[nodiscard]] const std::optional<models::TruthFrame>& truth() const { return truth_; }
  [[nodiscard]] const std::map<std::string, models::RobotBelief>& beliefs() const {
    return beliefs_;
  }
  [[nodiscard]] const std::map<std::string, models::RobotMap>& maps() const { return maps_; }
  /// Returns the scene with the team's newest evaluated estimates.
  [[nodiscard]] logs::Scene scene() const;

 private:
  logs::TrialMetrics metrics_;
  logs::SceneRecorder recorder_;
  std::set<std::string> robots_;  ///< names of the scenario's robots
  std::optional<models::TruthFrame> truth_;
  std::map<std::string, models::RobotBelief> beliefs_;  ///< newest belief of each robot
  std::map<std::string, models::RobotMap> maps_;        ///< newest map of each robot
};

}  // namespace vantage::trial
