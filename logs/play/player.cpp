#include "logs/play/player.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include <sys/prctl.h>

#include "core/deadline.hpp"
#include "core/saturated_time.hpp"

namespace vantage::logs {
namespace {

constexpr std::int64_t kAttentionNs = 20'000'000;
constexpr double kStepS = 5.0;
constexpr double kSpeedMin = 1.0 / 64.0;
constexpr double kSpeedMax = 64.0;

std::optional<double> number_in(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' || !(std::abs(value) < 1e12) ? std::nullopt
                                                                   : std::optional(value);
}

}  // namespace

std::optional<PlayCommand> parse_play_command(const std::string& text) {
  using Kind = PlayCommand::Kind;
  static const std::map<std::string, PlayCommand> kWords{{" ", {Kind::kToggle}},
                                                         {"q", {Kind::kQuit}},
                                                         {"quit", {Kind::kQuit}},
                                                         {"pause", {Kind::kPause}},
                                                         {"resume", {Kind::kResume}},
                                                         {"+", {Kind::kFaster}},
                                                         {"=", {Kind::kFaster}},
                                                         {"-", {Kind::kSlower}},
                                                         {"f", {Kind::kStep, kStepS}},
                                                         {"b", {Kind::kStep, -kStepS}},
                                                         {"\x1b[C", {Kind::kStep, kStepS}},
                                                         {"\x1b[D", {Kind::kStep, -kStepS}},
                                                         {"\x1b[A", {Kind::kFaster}},
                                                         {"\x1b[B", {Kind::kSlower}}};
  if (const auto word = kWords.find(text); word != kWords.end()) {
    return word->second;
  }
  const std::size_t space = text.find(' ');
  if (space == std::string::npos) {
    return std::nullopt;
  }
  const std::string verb = text.substr(0, space);
  const auto value = number_in(text.substr(space + 1));
  if (!value) {
    return std::nullopt;
  }
  if (verb == "seek") {
    return PlayCommand{Kind::kSeek, *value};
  }
  if (verb == "step") {
    return PlayCommand{Kind::kStep, *value};
  }
  if (verb == "speed" && *value >= kSpeedMin && *value <= kSpeedMax) {
    return PlayCommand{Kind::kSpeed, *value};
  }
  return std::nullopt;
}

PlayTimer monotonic_timer() {
  prctl(PR_SET_TIMERSLACK, 1UL);  // 1 ns instead of the default of 50 µs
  return {[] { return monotonic_ns(); },
          [](std::int64_t until_ns) {
            constexpr std::int64_t kNsPerS = 1'000'000'000;
            const timespec until{until_ns / kNsPerS, until_ns % kNsPerS};
            clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
          }};
}

Player::Player(const IndexedLog& log, PlayOptions options, PlayTimer timer, EventSink sink)
    : log_(log),
      options_(std::move(options)),
      timer_(std::move(timer)),
      sink_(std::move(sink)),
      begin_(std::max(options_.rules.from, log.survey().first)),
      end_(std::min(options_.rules.to, saturated_sum(log.survey().last, Duration{1}))),
      schedule_(begin_, options_.speed),
      scan_(log.scan_from(begin_)) {
  next_ = scan_.next();
}

void Player::seek(Time position) {
  position = std::clamp(position, begin_, std::max(begin_, end_));
  schedule_.seek(position, timer_.now_ns());
  scan_ = log_.scan_from(position);
  next_ = scan_.next();
}

bool Player::execute(const PlayCommand& command) {
  using Kind = PlayCommand::Kind;
  const std::int64_t now_ns = timer_.now_ns();
  const auto set_speed = [&](double speed) {
    schedule_.set_speed(std::clamp(speed, kSpeedMin, kSpeedMax), now_ns);
  };
  const bool pauses =
      command.kind == Kind::kPause || (command.kind == Kind::kToggle && !schedule_.is_paused());
  switch (command.kind) {
    case Kind::kPause:
    case Kind::kResume:
    case Kind::kToggle:
      pauses ? schedule_.pause(now_ns) : schedule_.resume(now_ns);
      return false;
    case Kind::kSpeed:
      set_speed(command.value);
      return false;
    case Kind::kFaster:
      set_speed(2.0 * schedule_.speed());
      return false;
    case Kind::kSlower:
      set_speed(0.5 * schedule_.speed());
      return false;
    case Kind::kSeek:
      seek(saturated_sum(log_.survey().begin, from_seconds(command.value)));
      return true;
    case Kind::kStep:
      seek(saturated_sum(schedule_.position(now_ns), from_seconds(command.value)));
      return true;
    case Kind::kQuit:
      is_over_ = true;
      return true;
  }
  return false;
}

void Player::publish(const LogEvent& event) {
  if (!options_.rules.channels.takes(event.channel)) {
    return;
  }
  const auto name = options_.rules.names.rename(event.channel);
  LogEvent renamed = event;
  renamed.channel = name ? *name : std::string_view();
  const std::int64_t due_ns = schedule_.due_ns(event.time);
  if (!name || !sink_(renamed)) {
    ++report_.failed;
    return;
  }
  const double late_us = 1e-3 * static_cast<double>(timer_.now_ns() - due_ns);
  ++report_.published;
  report_.late_mean_us += (late_us - report_.late_mean_us) / static_cast<double>(report_.published);
  report_.late_worst_us = std::max(report_.late_worst_us, late_us);
  report_.late_over_1_ms += late_us > 1e3 ? 1 : 0;
}

PlayReport Player::run(const std::function<std::optional<PlayCommand>()>& command,
                       const std::function<bool()>& stop,
                       const std::function<void(const PlaySchedule&, Time)>& on_position,
                       const std::function<void(Time from, Time to)>& on_gap) {
  if (!options_.starts_paused) {
    schedule_.resume(timer_.now_ns());
  }
  std::int64_t attention_ns = timer_.now_ns();
  while (!is_over_) {
    const std::int64_t now_ns = timer_.now_ns();
    if (now_ns >= attention_ns) {
      attention_ns = now_ns + kAttentionNs;
      is_over_ |= stop();
      while (const auto request = command()) {
        execute(*request);
      }
      if (on_position) {
        on_position(schedule_, schedule_.position(timer_.now_ns()));
      }
      continue;
    }
    const bool is_past_end = next_ && !options_.rules.is_before_end(next_->time);
    const bool is_at_end = !next_ || (is_past_end && log_.survey().times_backward == 0);
    if (schedule_.is_paused() && !is_at_end) {
      timer_.sleep_until_ns(attention_ns);
    } else if (is_at_end) {
      ++report_.passes;
      is_over_ = !options_.loops || log_.survey().scan.events == 0;
      if (!is_over_) {
        seek(begin_);
      }
    } else if (next_->time < begin_ || is_past_end) {
      next_ = scan_.next();
    } else if (const Time here = schedule_.position(now_ns);
               next_->time > saturated_sum(here, options_.gap_max) ||
               next_->time < saturated_sum(here, -options_.gap_max)) {
      ++report_.gaps;
      if (on_gap) {
        on_gap(here, next_->time);
      }
      schedule_.seek(std::max(next_->time - kAfterGap, Time{}), now_ns);
    } else if (schedule_.due_ns(next_->time) > now_ns) {
      timer_.sleep_until_ns(std::min(schedule_.due_ns(next_->time), attention_ns));
    } else {
      publish(*next_);
      next_ = scan_.next();
    }
  }
  return report_;
}

}  // namespace vantage::logs
