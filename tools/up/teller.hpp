#pragma once

#include <deque>
#include <string>

#include "logs/metrics/trial_metrics.hpp"
#include "scenario/scenario.hpp"
#include "tools/live/screen.hpp"
#include "tools/up/host_board.hpp"
#include "tools/up/up.hpp"

namespace vantage::tools {

/// Tells the person in front of it how things are: a table in place, or lines.
class Teller {
 public:
  /// `options` must outlive it.
  explicit Teller(const UpOptions& options) : options_(options) {}

  /// What happened.
  void say(const std::string& words);
  /// How the trial is, not more often than is of use.
  void show(Time now, const scenario::Scenario& scenario, const logs::TrialMetrics& metrics,
            double elapsed_s, const HostBoard& board);

 private:
  const UpOptions& options_;
  Screen screen_;
  std::deque<std::string> recent_;
  Time next_{};
};

}  // namespace vantage::tools
