#include "tools/view/log_view.hpp"

#include <map>

namespace vantage::tools {
namespace {

constexpr Duration kLeadUp = std::chrono::seconds(20);  // as long as a track
constexpr std::int64_t kTimePeriod_ns = 50'000'000;
constexpr std::size_t kHistoryBytesMax = std::size_t{256} << 20U;

/// Writes down what charts and marks need.
class History : public logs::foxglove::Sink {
 public:
  History(const bus::Clock& clock, logs::foxglove::Sink& audience)
      : clock_(clock), audience_(audience) {}

  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) override {
    using logs::foxglove::Schema;
    audience_.wants(topic, schema, is_state);
    switch (schema) {
      case Schema::kTeam:
      case Schema::kPlan:
      case Schema::kLog:
        return true;
      case Schema::kVehicle:
      case Schema::kHealth: {
        const auto last = written_.find(topic);
        return last == written_.end() || clock_.now() - last->second >= std::chrono::seconds(1);
      }
      default:
        return false;
    }
  }

  void write(const std::string& topic, Time time, const logs::foxglove::Json& content) override {
    using logs::foxglove::Json;
    written_[topic] = time;
    text_ += text_.empty() ? "[" : ",";
    text_ += Json::array({topic, to_utime(time), content})
                 .dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  [[nodiscard]] std::string text() const { return text_.empty() ? "[]" : text_ + "]"; }

 private:
  const bus::Clock& clock_;
  logs::foxglove::Sink& audience_;
  std::map<std::string, Time> written_;
  std::string text_;
};

}  // namespace

std::string log_history(const logs::EventTable& log, logs::foxglove::Sink& audience) {
  if (log.file_bytes() > kHistoryBytesMax) {
    return "[]";
  }
  bus::VirtualClock clock(log.start());
  bus::InProcessHub hub;
  const auto source = hub.connect();
  const auto endpoint = hub.connect();
  History history(clock, audience);
  Feed feed(*endpoint, clock, history);
  for (std::size_t i = 0; i < log.size(); ++i) {
    const logs::LogEvent event = log.read(i);
    clock.set(event.time);
    source->publish(std::string(event.channel), event.data);
    feed.handle(std::chrono::microseconds(0));
  }
  return history.text();
}

LogView::LogView(const logs::EventTable& log, Broker& broker)
    : log_(log), broker_(broker), playback_(log.start(), log.end()), clock_(log.start()) {
  go_to(log.start());
  broker_.broadcast_playback(playback_.state(0));
}

void LogView::go_to(Time position) {
  feed_.reset();
  endpoint_.reset();
  source_.reset();
  hub_ = std::make_unique<bus::InProcessHub>();
  source_ = hub_->connect();
  endpoint_ = hub_->connect();
  feed_ = std::make_unique<Feed>(*endpoint_, clock_, broker_);
  broker_.hold();
  broker_.forget();
  next_ = log_.first_at(position - kLeadUp);
  for (const std::size_t index : log_.newest_before(next_)) {
    feed(index);
  }
  for (; next_ < log_.size() && log_.time(next_) <= position; ++next_) {
    feed(next_);
  }
  broker_.release();
  broker_.broadcast_time(position);
}

void LogView::feed(std::size_t index) {
  const logs::LogEvent event = log_.read(index);
  clock_.set(event.time);
  source_->publish(std::string(event.channel), event.data);
  feed_->handle(std::chrono::microseconds(0));
}

void LogView::tick(std::int64_t now_ns) {
  for (const PlaybackControl& request : broker_.take_controls()) {
    const PlaybackState after = playback_.control(request, now_ns);
    broker_.broadcast_playback(after);
    status_told_ = after.status;
    if (after.did_seek) {
      go_to(after.time);
    }
  }
  const PlaybackState state = playback_.state(now_ns);
  for (; next_ < log_.size() && log_.time(next_) <= state.time; ++next_) {
    feed(next_);
  }
  if (state.status == PlaybackStatus::kPlaying && now_ns - time_told_ns_ >= kTimePeriod_ns) {
    time_told_ns_ = now_ns;
    broker_.broadcast_time(state.time);
  }
  if (state.status != status_told_) {
    status_told_ = state.status;
    broker_.broadcast_time(state.time);
    broker_.broadcast_playback(state);
  }
}

}  // namespace vantage::tools
