#include "logs/file/log_survey.hpp"

#include <algorithm>

#include "bus/convert/channels.hpp"
#include "bus/node/stream_monitor.hpp"
#include "logs/file/wire_witness.hpp"

namespace vantage::logs {
namespace {

/// A seek into pages that are not in memory waits for a block: 1 MiB took 23 ms of a slow disk.
constexpr std::size_t kBlockBytes = std::size_t{1} << 18U;
constexpr std::size_t kProgressReports = 100;

/// Every message of the house begins so, after its fingerprint: utime, run_id, sequence.
models::Stamp stamp_of(std::span<const std::uint8_t> data) {
  const auto number = [&](std::size_t at) {
    return static_cast<std::int64_t>(read_big_endian(data.data() + at, 8));
  };
  return {from_utime(number(8)), number(16), number(24)};
}

class Surveyor {
 public:
  void add(const PlacedEvent& event) {
    add_times_and_number(event);
    add_to_block(event);
    add_to_channel(event);
    survey_.begins_with_scenario |= events_ == 0 && event.channel == bus::kScenario.name;
    ++events_;
  }

  LogSurvey finish(const LogScan& scan, std::size_t size_bytes) {
    survey_.size_bytes = size_bytes;
    survey_.scan = scan.counts();
    survey_.stretches = scan.stretches();
    for (const auto& [name, monitor] : streams_) {
      survey_.channels[name].messages_lost = monitor.counts().lost;
    }
    return std::move(survey_);
  }

 private:
  void add_times_and_number(const PlacedEvent& event) {
    if (events_ == 0) {
      survey_.first = survey_.last = event.time;
    } else {
      const std::int64_t step = event.number - last_number_;
      survey_.numbers_missing += step > 1 ? step - 1 : 0;
      survey_.number_restarts += step < 1 ? 1 : 0;
      if (event.time < last_time_) {
        ++survey_.times_backward;
        survey_.backward_max = std::max(survey_.backward_max, last_time_ - event.time);
      }
    }
    survey_.first = std::min(survey_.first, event.time);
    survey_.last = std::max(survey_.last, event.time);
    last_number_ = event.number;
    last_time_ = event.time;
  }

  void add_to_block(const PlacedEvent& event) {
    auto& blocks = survey_.blocks;
    if (blocks.empty() || event.offset - blocks.back().offset >= kBlockBytes) {
      blocks.push_back({event.offset, events_, event.time, event.time});
    }
    blocks.back().time_min = std::min(blocks.back().time_min, event.time);
    blocks.back().time_max = std::max(blocks.back().time_max, event.time);
  }

  void add_to_channel(const PlacedEvent& event) {
    const std::string name(event.channel);
    ChannelSurvey& channel = survey_.channels[name];
    const bus::WireSchema* schema = type_of(event.data);
    const std::string_view type = schema == nullptr ? std::string_view() : schema->name;
    if (channel.events == 0) {
      channel.type = type;
      channel.first = event.time;
    } else if (event.time - channel.last > channel.gap_max) {
      channel.gap_max = event.time - channel.last;
      channel.gap_at = channel.last;
    }
    channel.other_types += type == channel.type ? 0 : 1;
    channel.last = event.time;
    ++channel.events;
    channel.data_bytes += event.data.size();
    if (schema != nullptr && stamp_of(event.data).sequence >= 0) {
      static_cast<void>(streams_[name].judge(stamp_of(event.data)));
    }
  }

  LogSurvey survey_;
  std::map<std::string, bus::SharedStreamMonitor> streams_;
  std::int64_t events_ = 0;
  std::int64_t last_number_ = 0;
  Time last_time_{};
};

}  // namespace

LogSurvey survey_log(std::span<const std::uint8_t> log,
                     const std::function<void(double)>& progress) {
  LogScan scan(log, wire_testimony);
  Surveyor surveyor;
  std::size_t next_report = log.size() / kProgressReports;
  while (const auto event = scan.next()) {
    surveyor.add(*event);
    if (progress && event->offset >= next_report) {
      progress(static_cast<double>(event->offset) / static_cast<double>(log.size()));
      next_report = event->offset + log.size() / kProgressReports;
    }
  }
  if (progress) {
    progress(1.0);
  }
  return surveyor.finish(scan, log.size());
}

std::size_t seek_offset(std::span<const std::uint8_t> log, const LogSurvey& survey, Time time) {
  const auto block = std::find_if(survey.blocks.begin(), survey.blocks.end(),
                                  [&](const LogBlock& each) { return each.time_max >= time; });
  if (block == survey.blocks.end()) {
    return log.size();
  }
  LogScan scan(log, wire_testimony, block->offset);
  while (const auto event = scan.next()) {
    if (event->time >= time) {
      return event->offset;
    }
  }
  return log.size();
}

}  // namespace vantage::logs
