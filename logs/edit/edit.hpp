#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "core/time.hpp"
#include "logs/edit/channel_rules.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

/// Function that writes one event. Returns false if that fails.
using EventSink = std::function<bool(const LogEvent&)>;

struct EditRules {
  Time from = Time::min();
  Time to = Time::max();  ///< end of the range, exclusive; Time::max(): none
  ChannelFilter channels;
  ChannelRenames names;
  bool drops_doubtful = false;
  /// Called for each event. If it returns true, the edit stops.
  std::function<bool()> stop = [] { return false; };

  [[nodiscard]] bool is_before_end(Time time) const { return time < to || to == Time::max(); }
};

struct EditCounts {
  std::int64_t written = 0;
  /// Number of events left out between the first and the last written event.
  std::int64_t left_out = 0;
  std::int64_t invalid_names = 0;  ///< events left out because their new name is empty or too long
  std::int64_t failed = 0;  ///< events that could not be written; the first failure ends the edit
  bool is_stopped = false;  ///< ended early by the caller's request
};

/// Passes the events of `log` that `rules` select to `sink`, in file order.
///
/// If the selection begins later than the log and includes SCENARIO, the output starts with the
/// newest earlier SCENARIO, stamped with `rules.from`, so that every log contains its scenario.
EditCounts edit_log(const IndexedLog& log, EditRules& rules, const EventSink& sink);

/// Passes the events of all `logs` to `sink` by ascending time. Events with equal times are in the
/// order of `logs`. The order within each log is kept.
EditCounts merge_logs(
    const std::vector<const IndexedLog*>& logs, const EventSink& sink,
    const std::function<bool()>& stop = [] { return false; });

}  // namespace vantage::logs
