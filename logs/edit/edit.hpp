#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "core/time.hpp"
#include "logs/edit/channel_rules.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

/// Takes one event; false when it could not be written.
using EventSink = std::function<bool(const LogEvent&)>;

struct EditRules {
  Time from = Time::min();
  Time to = Time::max();  ///< not included; Time::max(): no end
  ChannelFilter channels;
  ChannelRenames names;
  bool drops_doubtful = false;
  std::function<bool()> stop = [] { return false; };  ///< asked at each event; true ends it there

  [[nodiscard]] bool is_before_end(Time time) const { return time < to || to == Time::max(); }
};

struct EditCounts {
  std::int64_t written = 0;
  std::int64_t left_out = 0;       ///< of those between the first and the last written
  std::int64_t name_too_long = 0;  ///< left out because of that
  std::int64_t failed = 0;         ///< could not be written: the first of them ended it
  bool is_stopped = false;         ///< before the end, by who asked for it
};

/// Hands what `rules` leave of `log` to `sink`, in file order.
///
/// A part that begins later than the log, and that SCENARIO belongs to, begins with the newest
/// SCENARIO from before it, stamped with `rules.from`: every log says what was flown.
EditCounts edit_log(const IndexedLog& log, EditRules& rules, const EventSink& sink);

/// Hands the events of all `logs` to `sink` in the order of their times; of equal times the log
/// named first comes first, and each log's own order stands.
EditCounts merge_logs(
    const std::vector<const IndexedLog*>& logs, const EventSink& sink,
    const std::function<bool()>& stop = [] { return false; });

}  // namespace vantage::logs
