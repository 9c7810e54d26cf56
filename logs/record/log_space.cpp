#include "logs/record/log_space.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace vantage::logs {
namespace {

constexpr double kMega = 1e6;

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / kMega);
}

}  // namespace

std::uint64_t log_bytes_needed(const scenario::Scenario& scenario) {
  const double rate = kLogBytesPerRobotS * static_cast<double>(scenario.robots.size());
  return static_cast<std::uint64_t>(rate * (scenario.duration_s + kLogSpareS));
}

LogSpaceCheck check_log_space(const scenario::Scenario& scenario, const std::string& path,
                              std::optional<std::uint64_t> free_bytes) {
  const std::uint64_t needed_bytes = log_bytes_needed(scenario);
  if (!free_bytes) {
    return {true, "log: the free disk space is unknown for " + path};
  }
  const std::string summary = fmt::format(
      "log: {} free on the disk of {}; a log of {:g} s takes at most {}", megabytes(*free_bytes),
      path, scenario.duration_s + kLogSpareS, megabytes(needed_bytes));
  return {*free_bytes >= needed_bytes, summary};
}

LogWatch::State LogWatch::judge(Time now) const {
  if (last_.is_refused || (grown_at_ && to_seconds(now - *grown_at_) >= kUnwrittenS)) {
    return State::kUnwritten;
  }
  const bool is_nearly_full =
      last_.free_bytes && static_cast<double>(*last_.free_bytes) < bytes_per_s_ * kNearlyFullS;
  return is_nearly_full ? State::kNearlyFull : State::kWritten;
}

std::optional<std::string> LogWatch::update(const Observation& observation, Time now) {
  if (!grown_at_ || observation.size_bytes > last_.size_bytes) {
    grown_at_ = now;
  }
  last_ = observation;
  ++observations_;
  const State before = state_;
  state_ = judge(now);
  if (state_ == before) {
    return std::nullopt;
  }
  const std::string left =
      observation.free_bytes ? megabytes(*observation.free_bytes) : "an unknown amount";
  switch (state_) {
    case State::kUnwritten:
      ++times_unwritten_;
      return fmt::format(
          "LOG NOT WRITTEN for {:.0f} s, with {} free: the flight continues unrecorded",
          to_seconds(now - *grown_at_), left);
    case State::kNearlyFull:
      return fmt::format("log: only {} of disk space are left, enough for {:.0f} s of flight", left,
                         static_cast<double>(observation.free_bytes.value_or(0)) / bytes_per_s_);
    case State::kWritten:
      return fmt::format("log: written as usual, with {} free", left);
  }
  return std::nullopt;
}

models::ProcessHealth LogWatch::health(Time now) const {
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  models::ProcessHealth out;
  out.stamp.time = now;
  out.process = kLogHealth;
  out.state =
      state_ == State::kWritten ? models::ProcessState::kRunning : models::ProcessState::kDegraded;
  out.loops = observations_;
  out.counters = {
      {"log.bytes", static_cast<std::int64_t>(last_.size_bytes)},
      {"log.free_bytes", static_cast<std::int64_t>(std::min(last_.free_bytes.value_or(0), kMost))},
      {"log.is_written", is_written() ? 1 : 0},
      {"log.times_unwritten", times_unwritten_}};
  return out;
}

}  // namespace vantage::logs
