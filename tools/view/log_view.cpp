#include "tools/view/log_view.hpp"

#include <functional>
#include <set>
#include <utility>

#include "tools/view/history.hpp"

namespace vantage::tools {
namespace {

constexpr Duration kLeadUp = std::chrono::seconds(20);  // as long as a track
constexpr std::int64_t kTimePeriod_ns = 50'000'000;
constexpr std::size_t kWholeBytesMax = std::size_t{256} << 20U;
constexpr Duration kOvertureMax = std::chrono::minutes(2);
constexpr Duration kStepMin = std::chrono::milliseconds(1);
constexpr Duration kStepMax = std::chrono::seconds(1);

/// Hears one number of one topic.
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

/// Hears how much of a picture there is.
class Overture : public logs::foxglove::Sink {
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

  /// How much there is, in [0, 3].
  [[nodiscard]] int parts() const {
    return robots_.empty() ? 0
                           : (is_placed() ? 1 : 0) + (is_known_ ? 1 : 0) +
                                 (planned_.size() >= robots_.size() ? 1 : 0);
  }
  static constexpr int kAll = 3;

 private:
  [[nodiscard]] bool is_placed() const { return !robots_.empty() && missing_.empty(); }

  std::set<std::string> robots_;
  std::set<std::string> missing_;  ///< robots that nobody has placed yet
  std::set<std::string> planned_;
  bool is_known_ = false;
};

/// Plays a log from its start to a Sink, as fast as it goes, while `go_on` of each event's instant.
void play_through(const logs::EventTable& log, const logs::TypeLibrary& types,
                  bus::VirtualClock& clock, logs::foxglove::Sink& sink,
                  const std::function<bool(Time)>& go_on) {
  bus::InProcessHub hub;
  const auto source = hub.connect();
  const auto endpoint = hub.connect();
  Feed feed(*endpoint, clock, sink, types);
  for (std::size_t i = 0; i < log.size(); ++i) {
    const logs::LogEvent event = log.read(i);
    clock.set(event.time);
    source->publish(std::string(event.channel), event.data);
    feed.handle(std::chrono::microseconds(0));
    if (!go_on(event.time)) {
      return;
    }
  }
}

constexpr auto kToTheEnd = [](Time /*time*/) { return true; };

}  // namespace

std::string log_history(const logs::EventTable& log, const logs::TypeLibrary& types,
                        logs::foxglove::Sink& audience) {
  if (log.file_bytes() > kWholeBytesMax) {
    return "[]";
  }
  bus::VirtualClock clock(log.start());
  History history(clock, audience, History::Audience::kIsAskedOnly, kWholeBytesMax);
  play_through(log, types, clock, history, kToTheEnd);
  return history.text();
}

std::string log_series(const logs::EventTable& log, const logs::TypeLibrary& types,
                       const std::string& topic, const std::string& pointer) {
  if (log.file_bytes() > kWholeBytesMax || (!pointer.empty() && pointer.front() != '/')) {
    return "[]";
  }
  Series series(topic, pointer);
  if (!topic.starts_with(kRawTopics)) {
    bus::VirtualClock clock(log.start());
    play_through(log, types, clock, series, kToTheEnd);
    return series.text();
  }
  const std::string channel = topic.substr(kRawTopics.size());
  for (std::size_t i = 0; i < log.size(); ++i) {
    const logs::LogEvent event = log.read(i);
    if (event.channel == channel) {
      series.write(topic, event.time, raw_message(event.data, types));
    }
  }
  return series.text();
}

Time first_picture(const logs::EventTable& log) {
  Overture overture;
  bus::VirtualClock clock(log.start());
  Time best = log.start();
  int parts = 0;
  play_through(log, {}, clock, overture, [&](Time time) {
    if (overture.parts() > parts) {
      parts = overture.parts();
      best = time;
    }
    return parts < Overture::kAll && time - log.start() < kOvertureMax;
  });
  return best;
}

LogView::LogView(const logs::EventTable& log, const logs::TypeLibrary& types, Broker& broker,
                 Time begin)
    : log_(log),
      types_(types),
      broker_(broker),
      playback_(log.start(), log.end()),
      clock_(log.start()) {
  playback_.control({false, 1.0F, begin, ""}, 0);
  go_to(begin);
  broker_.broadcast_playback(playback_.state(0));
}

void LogView::go_to(Time position) {
  feed_.reset();
  endpoint_.reset();
  source_.reset();
  hub_ = std::make_unique<bus::InProcessHub>();
  source_ = hub_->connect();
  endpoint_ = hub_->connect();
  feed_ = std::make_unique<Feed>(*endpoint_, clock_, broker_, types_);
  broker_.hold();
  broker_.forget();
  next_ = log_.first_at(position - kLeadUp);
  for (const std::size_t index : log_.newest_before(next_)) {
    feed(index);
  }
  go_on_to(position);
  broker_.release();
  broker_.broadcast_time(position);
}

void LogView::go_on_to(Time position) {
  for (; next_ < log_.size() && log_.time(next_) <= position; ++next_) {
    feed(next_);
  }
  shown_ = position;
}

void LogView::feed(std::size_t index) {
  const logs::LogEvent event = log_.read(index);
  clock_.set(event.time);
  source_->publish(std::string(event.channel), event.data);
  feed_->handle(std::chrono::microseconds(0));
}

void LogView::tick(std::int64_t now_ns) {
  for (const PlaybackControl& request : broker_.take_controls()) {
    PlaybackState after = playback_.control(request, now_ns);
    // To go to where it is asks for all of that instant again.
    const bool is_step =
        after.did_seek && after.time - shown_ >= kStepMin && after.time - shown_ <= kStepMax;
    after.did_seek = after.did_seek && !is_step;
    broker_.broadcast_playback(after);
    status_told_ = after.status;
    if (after.did_seek) {
      go_to(after.time);
    } else if (is_step) {
      go_on_to(after.time);
      broker_.broadcast_time(after.time);
    }
  }
  const PlaybackState state = playback_.state(now_ns);
  go_on_to(state.time);
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
