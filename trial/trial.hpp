#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/transport/transport.hpp"
#include "core/result.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "logs/picture/scene.hpp"
#include "logs/record/log_writer.hpp"
#include "logs/record/recorder.hpp"
#include "scenario/scenario.hpp"
#include "trial/observe/announcer.hpp"
#include "trial/observe/observer.hpp"
#include "trial/recipe.hpp"
#include "trial/virtual_loop.hpp"

namespace vantage::trial {

struct TrialOptions {
  std::string log_path;  ///< path of a new LCM event log of all messages; empty: no log
  /// Called about a hundred times with the completed share of the trial, 0 to 1.
  std::function<void(double)> progress;
  /// Called about twice per second of virtual time. If it returns true, the trial ends; log and
  /// summary are complete up to that instant.
  std::function<bool()> stop;
};

struct TrialResult {
  logs::TrialSummary summary;
  logs::Scene scene;
  /// Bytes that the robots sent to other robots, by kind of channel; empty without
  /// network.budget_kbitps and network.simulation.
  std::vector<models::NamedCount> air_bytes;
  bool was_stopped = false;  ///< true: the trial ended before the scenario's duration
  /// error that made the log incomplete and ended the trial
  std::optional<Error> log_error = std::nullopt;
};

/// Trial in virtual time that is executed in parts. Messages, log and summary do not depend on the
/// division into parts.
class Trial {
 public:
  /// Creates the nodes, and a log if `log_path` is not empty. `scenario` must outlive the trial.
  /// Precondition: the scenario's planner.node_budget is positive.
  /// @throws StartupError when the log cannot be created or already exists, or a node refuses the
  ///         scenario.
  Trial(const scenario::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
        const std::string& log_path);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  Trial(Trial&&) = delete;
  Trial& operator=(Trial&&) = delete;

  /// Executes all instants before `end`, but at most to planned_end().
  void advance_to(Time end);
  [[nodiscard]] Time time() const { return now_; }
  [[nodiscard]] Time start() const { return start_; }
  [[nodiscard]] Time planned_end() const { return planned_end_; }
  [[nodiscard]] const TrialObserver& observer() const { return *observer_; }
  [[nodiscard]] bool is_log_lost() const { return log_ != nullptr && log_->error(); }
  /// Returns the result as if the trial ended now; the trial can continue.
  [[nodiscard]] TrialResult result();

 private:
  Time start_;
  Time planned_end_;
  Time now_;
  VirtualTimeLoop loop_;
  std::unique_ptr<logs::LogWriter> log_;
  std::unique_ptr<bus::Transport> recorded_;
  std::unique_ptr<logs::Recorder> recorder_;
  std::unique_ptr<TrialObserver> observer_;
  std::unique_ptr<Announcer> announcer_;
};

/// Returns the start of virtual time: 1 700 000 000 s, rounded up to a whole planning round.
Time trial_start(const scenario::Scenario& scenario);

/// Executes one trial in virtual time. The result depends only on the scenario (including its seed)
/// and the nodes. If the log can no longer be written, the trial ends as with `stop`; the file then
/// ends with a complete event.
/// Precondition: the scenario's planner.node_budget is positive.
/// @throws StartupError when the log cannot be created or already exists, or a node refuses the
///         scenario.
TrialResult run_trial(const scenario::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
                      const TrialOptions& options = {});

}  // namespace vantage::trial
