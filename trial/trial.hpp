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
  std::string log_path;  ///< an LCM event log of everything, a new file; empty: none
  /// Called with the share of the trial that is done, about a hundred times.
  std::function<void(double)> progress;
  /// Asked about twice a second of the trial; true ends it there. The log and the summary are whole
  /// up to that instant.
  std::function<bool()> stop;
};

struct TrialResult {
  logs::TrialSummary summary;
  logs::Scene scene;
  bool was_stopped = false;                       ///< before the scenario's duration
  std::optional<Error> log_error = std::nullopt;  ///< why the log is not whole; ended the trial
};

/// One trial in virtual time, in pieces: however its span is cut, the messages, the log and the
/// summary are those of a trial in one piece.
class Trial {
 public:
  /// `scenario` must outlive it; a log is written when `log_path` is not empty.
  /// Precondition: the scenario's planner.node_budget is positive.
  /// @throws StartupError when the log cannot be begun, or there is one at its path already, or a
  ///         node refuses the scenario.
  Trial(const scenario::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
        const std::string& log_path);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  Trial(Trial&&) = delete;
  Trial& operator=(Trial&&) = delete;

  /// Everything before `end`; not beyond planned_end().
  void advance_to(Time end);
  [[nodiscard]] Time time() const { return now_; }
  [[nodiscard]] Time start() const { return start_; }
  [[nodiscard]] Time planned_end() const { return planned_end_; }
  [[nodiscard]] const TrialObserver& observer() const { return *observer_; }
  [[nodiscard]] bool is_log_lost() const { return log_ != nullptr && log_->error(); }
  /// What the trial comes to if it ends here; it may go on.
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

/// When virtual time starts: 1 700 000 000 s, rounded up to a whole planning round.
Time trial_start(const scenario::Scenario& scenario);

/// One trial in virtual time: a pure function of the scenario (its seed included) and the nodes.
/// Precondition: the scenario's planner.node_budget is positive.
/// A log that cannot be written any more ends it as `stop` does: the file ends with a whole event.
/// @throws StartupError when the log cannot be begun, or there is one at its path already, or a
///         node refuses the scenario.
TrialResult run_trial(const scenario::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
                      const TrialOptions& options = {});

}  // namespace vantage::trial
