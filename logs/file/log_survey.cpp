#include "logs/file/log_survey.hpp"

#include <algorithm>

#include "bus/convert/channels.hpp"
#include "bus/node/publisher_watch.hpp"
#include "bus/node/stream_monitor.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

/// Size of a block. A seek into pages that are not in memory reads one block; a block of 1 MiB took
/// 23 ms on a slow disk.
constexpr std::size_t kBlockBytes = std::size_t{1} << 18U;
constexpr std::size_t kProgressReports = 100;

bool is_gap(Duration step) { return step < UsualTimes::kApart; }

/// Reads the stamp that follows the fingerprint in each vantage message: utime, run_id, sequence.
models::Stamp stamp_of(std::span<const std::uint8_t> data) {
  const auto number = [&](std::size_t at) {
    return static_cast<std::int64_t>(read_big_endian(data.data() + at, 8));
  };
  return {from_utime(number(8)), number(16), number(24)};
}

}  // namespace

struct SurveyPass::Streams {
  std::map<std::string, bus::SharedStreamMonitor> by_channel;
  bus::PublisherWatch publishers;
};

SurveyPass::SurveyPass(std::span<const std::uint8_t> log)
    : size_bytes_(log.size()), scan_(log, check_wire_data), streams_(std::make_unique<Streams>()) {}
SurveyPass::~SurveyPass() = default;
SurveyPass::SurveyPass(SurveyPass&&) noexcept = default;

std::size_t SurveyPass::position() const { return scan_.position(); }

bool SurveyPass::advance(std::size_t bytes) {
  const std::size_t until = scan_.position() + std::min(bytes, size_bytes_ - scan_.position());
  while (const auto event = scan_.next()) {
    add(*event);
    if (scan_.position() >= until && until < size_bytes_) {
      note_usual_times();
      return true;
    }
  }
  finish();
  return false;
}

void SurveyPass::note_usual_times() {
  const UsualTimes::Span span = times_.span();
  survey_.begin = span.begin;
  survey_.end = span.end;
  survey_.times_outlying = span.outlying;
}

void SurveyPass::finish() {
  note_usual_times();
  for (auto& [name, channel] : survey_.channels) {
    channel.first = std::clamp(channel.first, survey_.begin, survey_.end);
    channel.last = std::clamp(channel.last, survey_.begin, survey_.end);
  }
  survey_.size_bytes = size_bytes_;
  survey_.scan = scan_.counts();
  survey_.stretches = scan_.stretches();
  for (const auto& [name, monitor] : streams_->by_channel) {
    survey_.channels[name].messages_lost = monitor.counts().lost;
  }
  for (const std::string& name : streams_->publishers.contested()) {
    survey_.channels[name].has_two_publishers = true;
  }
}

void SurveyPass::add(const LocatedEvent& event) {
  add_times_and_number(event);
  add_to_block(event);
  add_to_channel(event);
  survey_.begins_with_scenario |= events_ == 0 && event.channel == bus::kScenario.name;
  ++events_;
}

void SurveyPass::add_times_and_number(const LocatedEvent& event) {
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
  times_.add(event.time);
  survey_.first = std::min(survey_.first, event.time);
  survey_.last = std::max(survey_.last, event.time);
  last_number_ = event.number;
  last_time_ = event.time;
}

void SurveyPass::add_to_block(const LocatedEvent& event) {
  auto& blocks = survey_.blocks;
  if (blocks.empty() || event.offset - blocks.back().offset >= kBlockBytes) {
    blocks.push_back({event.offset, events_, event.time, event.time});
  }
  blocks.back().time_min = std::min(blocks.back().time_min, event.time);
  blocks.back().time_max = std::max(blocks.back().time_max, event.time);
}

void SurveyPass::add_to_channel(const LocatedEvent& event) {
  const std::string name(event.channel);
  ChannelSurvey& channel = survey_.channels[name];
  const bus::WireSchema* schema = type_of(event.data);
  const std::string_view type = schema == nullptr ? std::string_view() : schema->name;
  if (channel.events == 0) {
    channel.type = type;
    channel.first = event.time;
  } else if (event.time - channel.last > channel.gap_max && is_gap(event.time - channel.last)) {
    channel.gap_max = event.time - channel.last;
    channel.gap_at = channel.last;
  }
  channel.other_types += type == channel.type ? 0 : 1;
  channel.last = event.time;
  ++channel.events;
  channel.data_bytes += event.data.size();
  const std::size_t block = survey_.blocks.size() - 1;
  channel.in_block.resize(block / 8 + 1);
  channel.in_block[block / 8] |= static_cast<std::uint8_t>(1U << (block % 8));
  if (schema != nullptr && stamp_of(event.data).sequence >= 0) {
    const models::Stamp stamp = stamp_of(event.data);
    static_cast<void>(streams_->by_channel[name].judge(stamp));
    streams_->publishers.on_run(name, stamp.run_id);
  }
}

LogSurvey survey_log(std::span<const std::uint8_t> log,
                     const std::function<void(double)>& progress) {
  SurveyPass pass(log);
  while (pass.advance(log.size() / kProgressReports + 1)) {
    if (progress) {
      progress(static_cast<double>(pass.position()) / static_cast<double>(log.size()));
    }
  }
  if (progress) {
    progress(1.0);
  }
  return pass.take();
}

std::size_t seek_offset(std::span<const std::uint8_t> log, const LogSurvey& survey, Time time) {
  const auto block = std::find_if(survey.blocks.begin(), survey.blocks.end(),
                                  [&](const LogBlock& each) { return each.time_max >= time; });
  if (block == survey.blocks.end()) {
    return log.size();
  }
  LogScan scan(log, check_wire_data, block->offset);
  while (const auto event = scan.next()) {
    if (event->time >= time) {
      return event->offset;
    }
  }
  return log.size();
}

}  // namespace vantage::logs
