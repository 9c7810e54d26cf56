#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "scenario/scenario.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {

/// Tells the person in front of it how a trial goes: a table in place, or lines.
class TrialDisplay {
 public:
  enum class Form { kQuiet, kLines, kTable };
  explicit TrialDisplay(Form form) : form_(form) {}

  /// What happened: also when quiet, on the other stream.
  void say(const std::string& words);
  /// Whether show() is of use: not when quiet, nor more often than anybody reads.
  [[nodiscard]] bool is_due(Time now) const { return form_ != Form::kQuiet && now >= next_; }
  /// How the trial is. `rows` stand below a table, with what happened last; `words` after a line.
  void show(Time now, const scenario::Scenario& scenario, const logs::TrialMetrics& metrics,
            double elapsed_s, const std::vector<std::string>& rows = {},
            const std::string& words = "");

 private:
  Form form_;
  Screen screen_;
  std::deque<std::string> recent_;
  Time next_{};
};

/// The form that options ask for.
inline TrialDisplay::Form form_of(bool is_quiet, bool is_table) {
  return is_quiet   ? TrialDisplay::Form::kQuiet
         : is_table ? TrialDisplay::Form::kTable
                    : TrialDisplay::Form::kLines;
}

}  // namespace vantage::tools
