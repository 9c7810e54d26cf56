#include "tools/view/log_view.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/saturated_time.hpp"
#include "tools/view/history.hpp"

namespace vantage::tools {
namespace {

constexpr Duration kPreroll = std::chrono::seconds(20);  // length of the bodies' displayed paths
constexpr std::int64_t kTimePeriod_ns = 50'000'000;
constexpr Duration kFirstPictureMax = std::chrono::minutes(2);
constexpr std::size_t kFirstPictureBytesMax = std::size_t{16} << 20U;
constexpr Duration kSlice = std::chrono::seconds(1);  // length of log that one step reads
constexpr Duration kTick{1};
constexpr Duration kStepMin = std::chrono::milliseconds(1);
constexpr Duration kStepMax = std::chrono::seconds(1);
constexpr std::size_t kPassBytes = std::size_t{1} << 20U;
constexpr const char* kReading = "reading";  // id of the status for the first pass's progress

/// Sink that collects one number of one topic.
class Series : public logs::foxglove::Sink {
 public:
  Series(std::string topic, const std::string& pointer)
      : topic_(std::move(topic)), pointer_(pointer) {}

  bool wants(const std::string& topic, logs::foxglove::Schema /*schema*/,
             bool /*is_state*/) override {
    return topic == topic_;
  }

  void write(const std::string& /*topic*/, Time time,
             const logs::foxglove::Json& content) override {
    if (!content.contains(pointer_)) {
      return;
    }
    const logs::foxglove::Json& value = content.at(pointer_);
    if (value.is_number() || value.is_boolean()) {
      const double number =
          value.is_boolean() ? (value.get<bool>() ? 1.0 : 0.0) : value.get<double>();
      points_.push_back({to_utime(time), number});
    }
  }

  [[nodiscard]] std::string text() const { return points_.dump(); }

 private:
  std::string topic_;
  logs::foxglove::Json::json_pointer pointer_;
  logs::foxglove::Json points_ = logs::foxglove::Json::array();
};

/// Sink that counts the conditions of first_picture() that are met.
class FirstPictureConditions : public logs::foxglove::Sink {
 public:
  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool /*is_state*/) override {
    using logs::foxglove::Schema;
    if (schema == Schema::kPlan) {
      planned_.insert(topic);
    }
    is_known_ = is_known_ || topic == "/map";
    return schema == Schema::kScenario || (topic == "/transforms" && !is_placed()) ||
           (topic == "/estimates" && !is_known_);
  }

  void write(const std::string& topic, Time /*time*/,
             const logs::foxglove::Json& content) override {
    if (topic == "/scenario") {
      robots_.clear();
      for (const auto& robot : content.at("robots")) {
        robots_.insert(robot.at("name").get<std::string>());
      }
      missing_ = robots_;
    } else if (topic == "/estimates") {
      is_known_ = !content.at("entities").empty();
    } else {
      for (const auto& transform : content.at("transforms")) {
        missing_.erase(transform.at("child_frame_id").get<std::string>());
      }
    }
  }

  /// Returns the number of conditions that are met, in [0, 3].
  [[nodiscard]] int parts() const {
    return robots_.empty() ? 0
                           : (is_placed() ? 1 : 0) + (is_known_ ? 1 : 0) +
                                 (planned_.size() >= robots_.size() ? 1 : 0);
  }
  static constexpr int kAll = 3;

 private:
  [[nodiscard]] bool is_placed() const { return !robots_.empty() && missing_.empty(); }

  std::set<std::string> robots_;
  std::set<std::string> missing_;  ///< robots that have no position yet
  std::set<std::string> planned_;
  bool is_known_ = false;
};

/// Calls `take` with the events within the range of a log by ascending time, until it returns
/// false.
void read_through(const logs::SeekableLog& log,
                  const std::function<bool(const logs::LocatedEvent&)>& take) {
  const auto [begin, end] = log.range();
  for (auto from = log.next_time(begin); from && *from <= end;) {
    const Time to = saturated_sum(*from, kSlice);
    for (const logs::LocatedEvent& event : log.events(*from, to)) {
      if (!take(event)) {
        return;
      }
    }
    from = to > *from ? log.next_time(to) : std::nullopt;
  }
}

/// Plays a log from its start to a Sink as fast as possible, until `go_on` returns false.
void play_through(const logs::SeekableLog& log, const logs::TypeLibrary& types,
                  bus::VirtualClock& clock, logs::foxglove::Sink& sink,
                  const std::function<bool(const logs::LocatedEvent&)>& go_on) {
  bus::InProcessHub hub;
  const auto source = hub.connect();
  const auto endpoint = hub.connect();
  Feed feed(*endpoint, clock, sink, types);
  read_through(log, [&](const logs::LocatedEvent& event) {
    clock.set(std::min(event.time, kClockTimeMax));
    source->publish(std::string(event.channel), event.data);
    feed.handle(std::chrono::microseconds(0));
    return go_on(event);
  });
}

}  // namespace

std::string log_history(const logs::SeekableLog& log, const logs::TypeLibrary& types,
                        logs::foxglove::Sink& audience, const std::function<bool()>& stop) {
  if (log.bytes().size() > kWholeBytesMax || !log.is_surveyed()) {
    return "[]";
  }
  bus::VirtualClock clock(log.range().first);
  History history(clock, audience, History::Forwarding::kWantsOnly, kWholeBytesMax);
  play_through(log, types, clock, history,
               [&](const logs::LocatedEvent& /*event*/) { return !stop(); });
  return history.text();
}

std::string log_series(const logs::SeekableLog& log, const logs::TypeLibrary& types,
                       const std::string& topic, const std::string& pointer) {
  if (log.bytes().size() > kWholeBytesMax || (!pointer.empty() && pointer.front() != '/')) {
    return "[]";
  }
  Series series(topic, pointer);
  if (!topic.starts_with(kRawTopics)) {
    bus::VirtualClock clock(log.range().first);
    play_through(log, types, clock, series,
                 [](const logs::LocatedEvent& /*event*/) { return true; });
    return series.text();
  }
  const std::string channel = topic.substr(kRawTopics.size());
  read_through(log, [&](const logs::LocatedEvent& event) {
    if (event.channel == channel) {
      series.write(topic, event.time, raw_message(event.data, types));
    }
    return true;
  });
  return series.text();
}

Time first_picture(const logs::SeekableLog& log, const std::function<bool()>& stop) {
  FirstPictureConditions conditions;
  bus::VirtualClock clock(log.range().first);
  const Time start = log.range().first;
  Time best = start;
  int parts = 0;
  play_through(log, {}, clock, conditions, [&](const logs::LocatedEvent& event) {
    if (conditions.parts() > parts) {
      parts = conditions.parts();
      best = event.time;
    }
    return !stop() && parts < FirstPictureConditions::kAll &&
           event.time - start < kFirstPictureMax && event.offset < kFirstPictureBytesMax;
  });
  return best;
}

void read_first_pass(logs::SeekableLog& log, Broker& broker, const std::function<bool()>& stop) {
  int sent_percent = -1;
  while (!stop() && log.advance(kPassBytes)) {
    const auto percent = static_cast<int>(100.0 * log.surveyed_share());
    if (percent > sent_percent) {
      sent_percent = percent;
      broker.set_status(kReading, fmt::format("{} % read", percent));
    }
  }
  if (sent_percent >= 0) {
    broker.set_status(kReading, "");
  }
}

LogView::LogView(const logs::SeekableLog& log, const logs::TypeLibrary& types, Broker& broker,
                 Time begin)
    : log_(log),
      types_(types),
      broker_(broker),
      preroll_(broker),
      playback_(log.range().first, log.range().second),
      clock_(log.range().first) {
  playback_.control({false, 1.0F, begin, ""}, 0);
  go_to(begin);
  broker_.broadcast_playback(playback_.state(0));
}

void LogView::reset_feed() {
  feed_.reset();
  endpoint_.reset();
  source_.reset();
  hub_ = std::make_unique<bus::InProcessHub>();
  source_ = hub_->connect();
  endpoint_ = hub_->connect();
  feed_ = std::make_unique<Feed>(*endpoint_, clock_, preroll_, types_);
}

void LogView::go_to(Time position) {
  broker_.hold();
  broker_.forget();
  is_exact_ = log_.is_surveyed();
  const Time from = position - kPreroll;
  const std::vector<logs::LocatedEvent> known = log_.newest_before(from);
  const std::vector<logs::LocatedEvent> since = log_.events(from, saturated_sum(position, kTick));
  const auto play = [&] {
    reset_feed();
    for (const auto* part : {&known, &since}) {
      for (const logs::LocatedEvent& event : *part) {
        feed(event);
      }
    }
  };
  preroll_.count();
  play();
  preroll_.make_last();
  play();
  preroll_.end();
  shown_ = position;
  broker_.reached(position);
  broker_.release();
  broker_.broadcast_time(position);
}

void LogView::advance_to(Time position) {
  if (position > shown_) {
    for (const logs::LocatedEvent& event :
         log_.events(saturated_sum(shown_, kTick), saturated_sum(position, kTick))) {
      feed(event);
      broker_.reached(event.time);
    }
    shown_ = position;
    broker_.reached(position);
  }
}

void LogView::feed(const logs::LocatedEvent& event) {
  clock_.set(std::min(event.time, kClockTimeMax));
  source_->publish(std::string(event.channel), event.data);
  feed_->handle(std::chrono::microseconds(0));
}

// Seeks to the current position again, with the range of the complete log.
void LogView::on_surveyed(std::int64_t now_ns) {
  const PlaybackState before = playback_.state(now_ns);
  const auto [start, end] = log_.range();
  playback_.set_range(start, end);
  broker_.set_range(start, end);
  PlaybackState after = playback_.control(
      {before.status == PlaybackStatus::kPlaying, before.speed, before.time, ""}, now_ns);
  broker_.broadcast_playback(after);
  status_sent_ = after.status;
  go_to(after.time);
}

void LogView::tick(std::int64_t now_ns) {
  if (!is_exact_ && log_.is_surveyed()) {
    on_surveyed(now_ns);
  }
  for (const PlaybackControl& request : broker_.take_controls()) {
    PlaybackState after = playback_.control(request, now_ns);
    // A seek to the current position reproduces the same state, so it does not count as a step.
    const bool is_step =
        after.did_seek && after.time - shown_ >= kStepMin && after.time - shown_ <= kStepMax;
    after.did_seek = after.did_seek && !is_step;
    broker_.broadcast_playback(after);
    status_sent_ = after.status;
    if (after.did_seek) {
      go_to(after.time);
    } else if (is_step) {
      advance_to(after.time);
      broker_.broadcast_time(after.time);
    }
  }
  const PlaybackState state = playback_.state(now_ns);
  advance_to(state.time);
  if (state.status == PlaybackStatus::kPlaying && now_ns - time_sent_ns_ >= kTimePeriod_ns) {
    time_sent_ns_ = now_ns;
    broker_.broadcast_time(state.time);
  }
  if (state.status != status_sent_) {
    status_sent_ = state.status;
    broker_.broadcast_time(state.time);
    broker_.broadcast_playback(state);
  }
}

}  // namespace vantage::tools
