#include "sim/firmware/firmware_flight.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/deadline.hpp"

namespace vantage::sim {
namespace {

constexpr std::int64_t kPatienceNs = FirmwareFlight::kPatience.count() * 1'000;
constexpr std::int64_t kExtrapolationMaxNs = 20'000'000;
constexpr Duration kSlice{20'000};  // maximum time between two checks of is_over_

void sleep_until_ns(std::int64_t monotonic_ns) {
  const timespec due{monotonic_ns / 1'000'000'000, monotonic_ns % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
}

}  // namespace

FirmwareFlight::FirmwareFlight(const MultirotorParameters& parameters, const SensorNoise& noise,
                               std::uint64_t seed, const Pose2& start,
                               std::unique_ptr<FirmwareLink> link)
    : body_(parameters, seed, start), board_(noise, seed), link_(std::move(link)) {
  record(monotonic_ns());
  samples_.fill(samples_[newest_]);
  thread_ = std::thread([this] { run(); });
}

FirmwareFlight::~FirmwareFlight() {
  is_over_ = true;
  thread_.join();
}

void FirmwareFlight::record(std::int64_t monotonic_ns) {
  const std::lock_guard lock(mutex_);
  newest_ = (newest_ + 1) % kSamples;
  samples_[newest_] = {monotonic_ns, body_.world_from_body(), body_.velocity_world_mps()};
  battery_share_ = body_.battery_share();
}

void FirmwareFlight::run() {
  const std::int64_t period_ns = link_->period().count() * 1'000;
  Duration elapsed{0};                   // simulated time of the body
  std::int64_t due_ns = monotonic_ns();  // monotonic time at which the next step is due
  std::int64_t received_ns = due_ns;
  Throttles throttles{};
  bool is_answered = !link_->is_lockstep();
  bool is_silent = true;
  Counts counts;
  while (!is_over_) {
    // In lockstep, the next motor command answers the last sensor message. After a gap, the
    // firmware may answer until the next sensor message is due; later answers are ignored.
    const std::int64_t spare_ns = std::max<std::int64_t>(0, due_ns + period_ns - monotonic_ns());
    const Duration wait = is_silent ? Duration{spare_ns / 1'000} : kSlice;
    if (const auto command =
            link_->receive(link_->is_lockstep() && !is_answered ? wait : Duration{0})) {
      throttles = command->throttles;
      is_answered = true;
      is_silent = false;
      received_ns = monotonic_ns();
    }
    const std::int64_t now_ns = monotonic_ns();
    if (!is_silent && now_ns - received_ns > kPatienceNs) {
      is_silent = true;
      throttles = {};
      ++counts.silences;
    }
    if (link_->is_lockstep() && !is_answered && !is_silent) {
      continue;  // the firmware is still computing its answer
    }
    if (now_ns - due_ns > 2 * kPatienceNs) {
      due_ns = now_ns;
      ++counts.resumed;
    }
    due_ns += period_ns;
    if (due_ns > now_ns) {
      sleep_until_ns(due_ns);
    }
    body_.step(throttles, static_cast<double>(period_ns) * 1e-9);
    elapsed += link_->period();
    record(due_ns);
    const bool is_sent = link_->send(board_.sample(body_, elapsed));
    is_answered = !link_->is_lockstep() || !is_sent;
    ++counts.steps;
    counts.dropped = link_->dropped();
    const std::lock_guard lock(mutex_);
    counts_ = counts;
  }
}

FirmwareFlight::Sample FirmwareFlight::at(std::int64_t monotonic_ns) const {
  const std::lock_guard lock(mutex_);
  const Sample* later = &samples_[newest_];
  if (monotonic_ns >= later->monotonic_ns) {
    Sample out = *later;
    const std::int64_t ahead_ns = std::min(monotonic_ns - out.monotonic_ns, kExtrapolationMaxNs);
    out.world_from_body.translation_m +=
        static_cast<double>(ahead_ns) * 1e-9 * out.velocity_world_mps;
    out.monotonic_ns += ahead_ns;
    return out;
  }
  for (std::size_t i = 1; i < kSamples; ++i) {
    const Sample& earlier = samples_[(newest_ + kSamples - i) % kSamples];
    if (earlier.monotonic_ns <= monotonic_ns) {
      const double whole_ns = static_cast<double>(later->monotonic_ns - earlier.monotonic_ns);
      const double share = whole_ns > 0.0
                               ? static_cast<double>(monotonic_ns - earlier.monotonic_ns) / whole_ns
                               : 0.0;
      Sample out;
      out.monotonic_ns = monotonic_ns;
      out.world_from_body.translation_m =
          earlier.world_from_body.translation_m +
          share * (later->world_from_body.translation_m - earlier.world_from_body.translation_m);
      out.world_from_body.rotation =
          earlier.world_from_body.rotation.slerp(share, later->world_from_body.rotation);
      out.velocity_world_mps = earlier.velocity_world_mps +
                               share * (later->velocity_world_mps - earlier.velocity_world_mps);
      return out;
    }
    later = &earlier;
  }
  return *later;
}

FirmwareFlight::Counts FirmwareFlight::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

double FirmwareFlight::battery_share() const {
  const std::lock_guard lock(mutex_);
  return battery_share_;
}

}  // namespace vantage::sim
