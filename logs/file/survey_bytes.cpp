#include "logs/file/survey_bytes.hpp"

#include <string>
#include <string_view>
#include <utility>

#include "logs/file/log_event.hpp"

namespace vantage::logs {
namespace {

constexpr std::size_t kNumberBytes = sizeof(std::uint64_t);

class Writer {
 public:
  explicit Writer(std::vector<std::uint8_t>& out) : out_(out) {}
  template <class Integer>
  void number(Integer value) {
    append_big_endian(static_cast<std::uint64_t>(value), kNumberBytes, out_);
  }
  void time(Time value) { number(to_utime(value)); }
  void duration(Duration value) { number(value.count()); }
  template <class Bytes>
  void bytes(const Bytes& value) {
    number(value.size());
    out_.insert(out_.end(), value.begin(), value.end());
  }

 private:
  std::vector<std::uint8_t>& out_;
};

/// Reader of numbers and text. After the first value that does not fit, all values are 0 and
/// is_good() is false.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> left) : left_(left) {}
  [[nodiscard]] bool is_good() const { return is_good_; }
  [[nodiscard]] bool is_at_end() const { return left_.empty(); }

  std::uint64_t number() {
    const auto bytes = take(kNumberBytes);
    return bytes.empty() ? 0 : read_big_endian(bytes.data(), kNumberBytes);
  }
  std::int64_t integer() { return static_cast<std::int64_t>(number()); }
  bool truth() {
    const std::uint64_t value = number();
    is_good_ = is_good_ && value <= 1;
    return value == 1;
  }
  /// Returns a time ≥ 0, as event_at() requires.
  Time time() {
    const std::int64_t utime = integer();
    is_good_ = is_good_ && utime >= 0;
    return from_utime(utime);
  }
  Duration duration() { return Duration{integer()}; }
  std::span<const std::uint8_t> bytes() { return take(number()); }
  std::string text() {
    const auto raw = bytes();
    return {raw.begin(), raw.end()};
  }
  /// Returns the number of elements that follow, each at least `least_bytes` long.
  std::size_t count(std::size_t least_bytes) {
    const std::uint64_t value = number();
    is_good_ = is_good_ && value <= left_.size() / least_bytes;
    return is_good_ ? static_cast<std::size_t>(value) : 0;
  }

 private:
  std::span<const std::uint8_t> take(std::uint64_t size) {
    is_good_ = is_good_ && size <= left_.size();
    if (!is_good_) {
      return {};
    }
    const auto out = left_.first(static_cast<std::size_t>(size));
    left_ = left_.subspan(static_cast<std::size_t>(size));
    return out;
  }

  std::span<const std::uint8_t> left_;
  bool is_good_ = true;
};

constexpr std::size_t kChannelNumbers = 12;  ///< per channel, including lengths of texts and bits
constexpr std::size_t kBlockNumbers = 4;
constexpr std::size_t kStretchNumbers = 3;

void append_channel(const std::string& name, const ChannelSurvey& channel, Writer& out) {
  out.bytes(name);
  out.bytes(channel.type);
  out.number(channel.events);
  out.number(channel.data_bytes);
  out.time(channel.first);
  out.time(channel.last);
  out.duration(channel.gap_max);
  out.time(channel.gap_at);
  out.number(channel.messages_lost);
  out.number(channel.other_types);
  out.number(channel.has_two_publishers ? 1 : 0);
  out.bytes(channel.in_block);
}

// Braced initialisation reads the values in the order of the members.
std::pair<std::string, ChannelSurvey> read_channel(Reader& in) {
  std::string name = in.text();
  ChannelSurvey channel{in.text(),    in.integer(),     in.number(), in.time(),
                        in.time(),    in.duration(),    in.time(),   in.integer(),
                        in.integer(), in.number() != 0, {}};
  const auto bits = in.bytes();
  channel.in_block.assign(bits.begin(), bits.end());
  return {std::move(name), std::move(channel)};
}

/// True if the blocks are in ascending order within the log.
bool are_blocks(const std::vector<LogBlock>& blocks, std::size_t log_bytes) {
  std::size_t end = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const LogBlock& block = blocks[i];
    if ((i > 0 && block.offset <= end) || block.offset >= log_bytes || block.first_event < 0 ||
        block.time_min > block.time_max) {
      return false;
    }
    end = block.offset;
  }
  return true;
}

}  // namespace

void append_survey(const LogSurvey& survey, std::vector<std::uint8_t>& bytes) {
  Writer out(bytes);
  out.number(survey.size_bytes);
  out.number(survey.scan.events);
  out.number(survey.scan.doubtful);
  out.number(survey.scan.refused);
  out.number(survey.scan.stretches);
  out.number(survey.scan.bytes_damaged);
  out.time(survey.first);
  out.time(survey.last);
  out.time(survey.begin);
  out.time(survey.end);
  out.number(survey.times_outlying);
  out.number(survey.numbers_missing);
  out.number(survey.number_restarts);
  out.number(survey.times_backward);
  out.duration(survey.backward_max);
  out.number(survey.begins_with_scenario ? 1 : 0);
  out.number(survey.stretches.size());
  for (const DamagedStretch& stretch : survey.stretches) {
    out.number(stretch.offset);
    out.number(stretch.size_bytes);
    out.number(stretch.is_tail ? 1 : 0);
  }
  out.number(survey.channels.size());
  for (const auto& [name, channel] : survey.channels) {
    append_channel(name, channel, out);
  }
  out.number(survey.blocks.size());
  for (const LogBlock& block : survey.blocks) {
    out.number(block.offset);
    out.number(block.first_event);
    out.time(block.time_min);
    out.time(block.time_max);
  }
}

std::optional<LogSurvey> survey_from(std::span<const std::uint8_t> bytes, std::size_t log_bytes) {
  Reader in(bytes);
  LogSurvey survey;
  survey.size_bytes = in.number();
  survey.scan = {in.integer(), in.integer(), in.integer(), in.integer(), in.number()};
  survey.first = in.time();
  survey.last = in.time();
  survey.begin = in.time();
  survey.end = in.time();
  survey.times_outlying = in.integer();
  survey.numbers_missing = in.integer();
  survey.number_restarts = in.integer();
  survey.times_backward = in.integer();
  survey.backward_max = in.duration();
  survey.begins_with_scenario = in.truth();
  for (std::size_t left = in.count(kStretchNumbers * kNumberBytes); left > 0; --left) {
    survey.stretches.push_back({in.number(), in.number(), in.truth()});
  }
  for (std::size_t left = in.count(kChannelNumbers * kNumberBytes); left > 0; --left) {
    survey.channels.insert(read_channel(in));
  }
  for (std::size_t left = in.count(kBlockNumbers * kNumberBytes); left > 0; --left) {
    survey.blocks.push_back({in.number(), in.integer(), in.time(), in.time()});
  }
  const bool is_survey = in.is_good() && in.is_at_end() && survey.first <= survey.last &&
                         survey.begin <= survey.end && survey.size_bytes == log_bytes &&
                         are_blocks(survey.blocks, log_bytes) && !survey.channels.empty() &&
                         !survey.blocks.empty();
  return is_survey ? std::optional(std::move(survey)) : std::nullopt;
}

}  // namespace vantage::logs
