#include "tools/live/trial_display.hpp"

#include <chrono>
#include <cstdio>

#include "tools/live/status_table.hpp"

namespace vantage::tools {
namespace {

constexpr Duration kTablePeriod = std::chrono::milliseconds(500);
constexpr Duration kLinePeriod = std::chrono::seconds(5);
constexpr std::size_t kRecentEvents = 6;

}  // namespace

void TrialDisplay::show_event(const std::string& words) {
  switch (form_) {
    case Form::kTable:
      recent_.push_back("! " + words);
      if (recent_.size() > kRecentEvents) {
        recent_.pop_front();
      }
      break;
    case Form::kQuiet:
      print_line("! " + words, stderr);
      break;
    case Form::kLines:
      print_line("! " + words);
      break;
  }
}

void TrialDisplay::show(Time now, const scenario::Scenario& scenario,
                        const logs::TrialMetrics& metrics, double elapsed_s,
                        const std::vector<std::string>& rows, const std::string& words) {
  if (form_ == Form::kTable) {
    std::vector<std::string> lines = status_table(scenario, metrics, elapsed_s, has_colour());
    if (!rows.empty()) {
      lines.emplace_back();
      lines.insert(lines.end(), rows.begin(), rows.end());
      lines.emplace_back();
      lines.insert(lines.end(), recent_.begin(), recent_.end());
    }
    screen_.redraw(lines);
    next_ = now + kTablePeriod;
  } else {
    print_line(status_line(metrics, elapsed_s) + (words.empty() ? "" : "   " + words));
    next_ = now + kLinePeriod;
  }
}

}  // namespace vantage::tools
