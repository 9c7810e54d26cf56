#pragma once

#include <optional>

#include "bus/bus.hpp"
#include "core/time.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "models/scenario/scenario.hpp"
#include "tools/picture/scene.hpp"

namespace vantage::tools {

/// Watches a whole trial over a bus: metrics for the numbers, a scene for the picture.
/// The bus must outlive it and be handled by its owner.
class TrialObserver {
 public:
  TrialObserver(bus::Bus& bus, const models::Scenario& scenario, Time start);
  TrialObserver(const TrialObserver&) = delete;
  TrialObserver& operator=(const TrialObserver&) = delete;
  TrialObserver(TrialObserver&&) = delete;
  TrialObserver& operator=(TrialObserver&&) = delete;
  ~TrialObserver() = default;

  [[nodiscard]] logs::TrialMetrics& metrics() { return metrics_; }
  /// The scene with the team's newest judged estimates in it.
  [[nodiscard]] Scene scene() const;

 private:
  logs::TrialMetrics metrics_;
  SceneRecorder recorder_;
};

}  // namespace vantage::tools
