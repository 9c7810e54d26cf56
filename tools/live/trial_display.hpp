#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "scenario/scenario.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {

/// Display of a running trial in a terminal: a table that is redrawn in place, or lines.
class TrialDisplay {
 public:
  enum class Form { kQuiet, kLines, kTable };
  explicit TrialDisplay(Form form) : form_(form) {}

  /// Shows an event. If quiet, writes it to standard error.
  void show_event(const std::string& words);
  /// True if show() should be called: not quiet, and the refresh period has passed.
  [[nodiscard]] bool is_due(Time now) const { return form_ != Form::kQuiet && now >= next_; }
  /// Shows the state of the trial. A table is followed by `rows` and the last events; a line is
  /// followed by `words`.
  void show(Time now, const scenario::Scenario& scenario, const logs::TrialMetrics& metrics,
            double elapsed_s, const std::vector<std::string>& rows = {},
            const std::string& words = "");

 private:
  Form form_;
  Screen screen_;
  std::deque<std::string> recent_;
  Time next_{};
};

/// Returns the form that options request.
inline TrialDisplay::Form form_of(bool is_quiet, bool is_table) {
  return is_quiet   ? TrialDisplay::Form::kQuiet
         : is_table ? TrialDisplay::Form::kTable
                    : TrialDisplay::Form::kLines;
}

}  // namespace vantage::tools
