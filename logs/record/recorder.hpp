#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "bus/transport/transport.hpp"
#include "logs/edit/channel_rules.hpp"
#include "logs/record/log_spool.hpp"

namespace vantage::logs {

/// Recorder that passes all messages which `endpoint` receives on selected channels to a log,
/// stamped with the stack's clock. Create it before any process publishes, so that the first event
/// is the first message.
class Recorder {
 public:
  /// Function that records one event. Returns false if the event is lost.
  using Log =
      std::function<bool(Time, std::string_view channel, std::span<const std::uint8_t> data)>;

  /// `endpoint` and `clock` must exist until the last call of the endpoint's handle().
  Recorder(bus::Transport& endpoint, const bus::Clock& clock, Log log, ChannelFilter channels = {});
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  Recorder(Recorder&&) = delete;
  Recorder& operator=(Recorder&&) = delete;
  ~Recorder() = default;

  [[nodiscard]] std::int64_t received() const { return received_; }
  /// Returns the number of messages that were not recorded because is_event_channel() refuses their
  /// channel: in a log these messages could not be distinguished from damage.
  [[nodiscard]] std::int64_t names_refused() const { return names_refused_; }

 private:
  Log log_;
  ChannelFilter channels_;
  std::int64_t received_ = 0;
  std::int64_t names_refused_ = 0;
};

/// Process that records a bus and reports the state of its log on HEALTH_RECORDER.
class RecorderNode : public bus::Node {
 public:
  /// @param report  called immediately for every failure of the log and for its end
  RecorderNode(bus::Transport& transport, const bus::Clock& clock, LogSpool& spool,
               ChannelFilter channels, std::function<void(const std::string&)> report);

  [[nodiscard]] std::string name() const override { return kName; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  /// Returns the counters that change in normal operation.
  [[nodiscard]] std::vector<models::NamedCount> traffic() const;
  [[nodiscard]] std::int64_t received() const { return recorder_.received(); }

  static constexpr const char* kName = "RECORDER";

 private:
  LogSpool& spool_;
  Recorder recorder_;
  std::function<void(const std::string&)> report_;
  Time next_tick_;
};

}  // namespace vantage::logs
