#pragma once

#include <map>
#include <optional>
#include <string>

#include "bus/node/bus.hpp"
#include "core/time.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "logs/picture/scene.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::trial {

/// Watches a whole trial over a bus: metrics for the numbers, a scene for the picture.
/// The bus must outlive it and be handled by its owner.
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
  /// As last heard; nullopt and empty before.
  [[nodiscard]] const std::optional<models::TruthFrame>& truth() const { return truth_; }
  [[nodiscard]] const std::map<std::string, models::RobotBelief>& beliefs() const {
    return beliefs_;
  }
  [[nodiscard]] const std::map<std::string, models::RobotMap>& maps() const { return maps_; }
  /// The scene with the team's newest judged estimates in it.
  [[nodiscard]] logs::Scene scene() const;

 private:
  logs::TrialMetrics metrics_;
  logs::SceneRecorder recorder_;
  std::optional<models::TruthFrame> truth_;
  std::map<std::string, models::RobotBelief> beliefs_;  ///< by robot
  std::map<std::string, models::RobotMap> maps_;        ///< by robot
};

}  // namespace vantage::trial
