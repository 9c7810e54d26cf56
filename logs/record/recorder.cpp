#include "logs/record/recorder.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "bus/node/air_budget.hpp"
#include "logs/file/log_event.hpp"

namespace vantage::logs {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(50);

std::int64_t count_of(std::uint64_t bytes) {
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return static_cast<std::int64_t>(std::min(bytes, kMost));
}

/// Detector of the second copies of messages that are published twice. Only the first copy is
/// recorded.
class Repeats {
 public:
  bool is_repeat(std::string_view channel, std::span<const std::uint8_t> data) {
    if (!bus::may_be_repeated(channel) || data.size() < kHeadBytes) {
      return false;
    }
    Head head{};
    std::copy_n(data.begin(), kHeadBytes, head.begin());
    const auto known = newest_.find(channel);
    if (known == newest_.end()) {
      if (newest_.size() < kChannelsMax) {
        newest_.emplace(channel, head);
      }
      return false;
    }
    return std::exchange(known->second, head) == head;
  }

 private:
  /// Bytes of type, time, run id and sequence number.
  static constexpr std::size_t kHeadBytes = 32;
  static constexpr std::size_t kChannelsMax = 4096;  ///< limits the memory
  using Head = std::array<std::uint8_t, kHeadBytes>;
  std::map<std::string, Head, std::less<>> newest_;  ///< newest head by channel
};

}  // namespace

Recorder::Recorder(bus::Transport& endpoint, const bus::Clock& clock, Log log,
                   ChannelFilter channels)
    : log_(std::move(log)), channels_(std::move(channels)) {
  endpoint.subscribe(
      "*", [this, &clock, repeats = Repeats()](std::string_view channel,
                                               std::span<const std::uint8_t> data) mutable {
        if (!is_event_channel(channel)) {
          ++names_refused_;
        } else if (channels_.takes(channel) && !repeats.is_repeat(channel, data)) {
          ++received_;
          log_(clock.now(), channel, data);
        }
      });
}

RecorderNode::RecorderNode(bus::Transport& transport, const bus::Clock& clock, LogSpool& spool,
                           ChannelFilter channels, std::function<void(const std::string&)> report)
    : spool_(spool),
      recorder_(
          transport, clock,
          [&spool](Time time, std::string_view channel, std::span<const std::uint8_t> data) {
            return spool.write(time, channel, data);
          },
          std::move(channels)),
      report_(std::move(report)),
      next_tick_(clock.now()) {}

void RecorderNode::tick(Time now) {
  next_tick_ = now + kTickPeriod;
  for (const std::string& notice : spool_.take_notices()) {
    report_(notice);
  }
}

std::vector<models::NamedCount> RecorderNode::counters() const {
  const SpoolReport report = spool_.report();
  return {{"log.events_lost", report.events_lost},
          {"log.write_errors", report.write_errors},
          {"log.sync_errors", report.sync_errors},
          {"log.syncs_late", report.syncs_late},
          {"log.names_refused", recorder_.names_refused()}};
}

std::vector<models::NamedCount> RecorderNode::traffic() const {
  const SpoolReport report = spool_.report();
  return {{"log.is_written", report.is_written ? 1 : 0},
          {"log.events", report.events},
          {"log.bytes", count_of(report.bytes)},
          {"log.files", report.files},
          {"log.queue_bytes", count_of(report.queue_bytes)},
          {"log.free_bytes", count_of(report.free_bytes.value_or(0))},
          {"log.at_risk_worst_us", report.at_risk_worst_us}};
}

}  // namespace vantage::logs
