#include "logs/edit/edit.hpp"

#include <algorithm>
#include <optional>

#include "bus/convert/channels.hpp"
#include "core/saturated_time.hpp"

namespace vantage::logs {
namespace {

/// The newest SCENARIO before the selected part is searched for in two ranges: kScenarioAge before
/// the part (SCENARIO is published every 5 s), then the log's first kScenarioWithin events.
constexpr Duration kScenarioAge{15'000'000};
constexpr int kScenarioWithin = 1000;

std::optional<LogEvent> scenario_before(const IndexedLog& log, Time time) {
  std::optional<LogEvent> newest;
  const auto is_scenario = [](const LogEvent& event) {
    return event.channel == bus::kScenario.name;
  };
  LogScan near = log.scan_from(saturated_sum(time, -kScenarioAge));
  for (auto event = near.next(); event && event->time < time; event = near.next()) {
    if (is_scenario(*event)) {
      newest = *event;
    }
  }
  if (!newest) {
    LogScan begin = log.scan();
    int seen = 0;
    for (auto event = begin.next(); event && event->time < time && seen < kScenarioWithin;
         event = begin.next(), ++seen) {
      if (is_scenario(*event)) {
        return *event;
      }
    }
  }
  return newest;
}

}  // namespace

EditCounts edit_log(const IndexedLog& log, EditRules& rules, const EventSink& sink) {
  EditCounts counts;
  const auto write = [&](LogEvent event) {
    const auto name = rules.names.rename(event.channel);
    if (!name) {
      ++counts.invalid_names;
      return;
    }
    event.channel = *name;
    ++(sink(event) ? counts.written : counts.failed);
  };
  const bool is_part = rules.from > log.survey().first;
  if (is_part && rules.channels.takes(bus::kScenario.name)) {
    if (auto scenario = scenario_before(log, rules.from)) {
      scenario->time = rules.from;
      write(*scenario);
    }
  }
  const bool is_sorted = log.survey().times_backward == 0;
  LogScan scan = log.scan_from(rules.from);
  while (const auto event = scan.next()) {
    counts.is_stopped = rules.stop();
    if (counts.is_stopped || counts.failed > 0) {
      break;
    }
    if (is_sorted && !rules.is_before_end(event->time)) {
      break;
    }
    if (event->time < rules.from || !rules.is_before_end(event->time) ||
        (rules.drops_doubtful && event->is_doubtful) || !rules.channels.takes(event->channel)) {
      ++counts.left_out;
      continue;
    }
    write(*event);
  }
  return counts;
}

EditCounts merge_logs(const std::vector<const IndexedLog*>& logs, const EventSink& sink,
                      const std::function<bool()>& stop) {
  struct Head {
    LogScan scan;
    std::optional<LocatedEvent> event;
  };
  std::vector<Head> heads;
  for (const IndexedLog* log : logs) {
    heads.push_back({log->scan(), std::nullopt});
    heads.back().event = heads.back().scan.next();
  }
  EditCounts counts;
  while (true) {
    const auto next =
        std::min_element(heads.begin(), heads.end(), [](const Head& a, const Head& b) {
          return a.event && (!b.event || a.event->time < b.event->time);
        });
    if (next == heads.end() || !next->event || counts.failed > 0) {
      return counts;
    }
    counts.is_stopped = stop();
    if (counts.is_stopped) {
      return counts;
    }
    ++(sink(*next->event) ? counts.written : counts.failed);
    next->event = next->scan.next();
  }
}

}  // namespace vantage::logs
