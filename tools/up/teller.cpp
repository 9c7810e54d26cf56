#include "tools/up/teller.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/live/status_table.hpp"

namespace vantage::tools {
namespace {

constexpr Duration kTablePeriod = std::chrono::milliseconds(500);
constexpr Duration kLinePeriod = std::chrono::seconds(5);
constexpr std::size_t kRecentEvents = 6;

}  // namespace

void Teller::say(const std::string& words) {
  if (options_.live_table) {
    recent_.push_back("! " + words);
    if (recent_.size() > kRecentEvents) {
      recent_.pop_front();
    }
  } else if (options_.quiet) {
    fmt::print(stderr, "! {}\n", words);
  } else {
    print_line("! " + words);
  }
}

void Teller::show(Time now, const scenario::Scenario& scenario, const logs::TrialMetrics& metrics,
                  double elapsed_s, const HostBoard& board) {
  if (options_.quiet || now < next_) {
    return;
  }
  if (options_.live_table) {
    std::vector<std::string> lines = status_table(scenario, metrics, elapsed_s, has_colour());
    lines.emplace_back();
    for (std::string& row : board.table(now)) {
      lines.push_back(std::move(row));
    }
    lines.emplace_back();
    lines.insert(lines.end(), recent_.begin(), recent_.end());
    screen_.redraw(lines);
    next_ = now + kTablePeriod;
  } else {
    const std::string hosts = board.line(now);
    print_line(status_line(metrics, elapsed_s) + (hosts.empty() ? "" : "   " + hosts));
    next_ = now + kLinePeriod;
  }
}

}  // namespace vantage::tools
