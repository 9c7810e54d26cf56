#include "bus/node/node.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <poll.h>

#include "bus/convert/channels.hpp"
#include "bus/node/normal_counters.hpp"
#include "core/deadline.hpp"
#include "core/processor_wait.hpp"

namespace vantage::bus {
namespace {

constexpr Duration kReportPeriod = std::chrono::seconds(1);
constexpr Duration kReportOnChangePeriod = std::chrono::milliseconds(100);
constexpr Duration kStopPollPeriod = std::chrono::milliseconds(50);
constexpr Duration kWaitPeriod = std::chrono::milliseconds(50);

/// Reporter of the time that the thread waited for a processor in the last second.
class WaitReporter {
 public:
  explicit WaitReporter(const WaitCounter& counter) : counter_(counter) {}
  void report(Node& node, Time now) {
    if (!counter_ || now < next_) {
      return;
    }
    next_ = now + kWaitPeriod;
    if (const auto waited_us = counter_()) {
      wait_.add(now, *waited_us);
      node.on_processor_wait(wait_.recent_s());
    }
  }

 private:
  const WaitCounter& counter_;
  ProcessorWait wait_;
  Time next_{};
};

/// Returns true if `fd` became readable within `timeout`.
bool wait_for(int fd, Duration timeout) {
  const timespec limit{timeout.count() / 1'000'000, timeout.count() % 1'000'000 * 1'000};
  pollfd polled{fd, POLLIN, 0};
  return ppoll(&polled, 1, &limit, nullptr) > 0;
}

}  // namespace

HealthReporter::HealthReporter(Bus& bus, const Node& node, Usage usage)
    : bus_(bus),
      node_(node),
      usage_(std::move(usage)),
      fault_sum_reported_(fault_sum()),
      fault_sum_last_second_(fault_sum_reported_) {}

std::int64_t HealthReporter::fault_sum() const {
  // Unsigned, because the sum with a saturated count may wrap. Only changes of the sum matter.
  auto sum = static_cast<std::uint64_t>(node_.deadlines_missed());
  for (const models::NamedCount& counter : bus_.counters()) {
    sum += is_normal_counter(counter.name) ? 0 : static_cast<std::uint64_t>(counter.count);
  }
  for (const models::NamedCount& counter : node_.counters()) {
    sum += is_normal_counter(counter.name) ? 0 : static_cast<std::uint64_t>(counter.count);
  }
  return static_cast<std::int64_t>(sum);
}

void HealthReporter::on_loop(Time now, double loop_s) {
  ++loops_;
  loop_worst_s_ = std::max(loop_worst_s_, loop_s);
  const bool is_due = now >= next_;
  if (!is_due && now < next_on_change_) {
    return;
  }
  const std::int64_t fault_sum_now = fault_sum();
  if (is_due || fault_sum_now != fault_sum_reported_) {
    const bool is_degraded = fault_sum_now != fault_sum_last_second_;
    publish(now, is_degraded ? models::ProcessState::kDegraded : models::ProcessState::kRunning);
    if (is_due) {
      fault_sum_last_second_ = fault_sum_now;
      next_ = now + kReportPeriod;
    }
  }
}

void HealthReporter::publish(Time now, models::ProcessState state) {
  models::ProcessHealth health;
  health.stamp.time = now;
  health.process = node_.name();
  health.state = state;
  health.counters = bus_.counters();
  for (models::NamedCount& counter : node_.counters()) {
    health.counters.push_back(std::move(counter));
  }
  if (usage_) {
    for (models::NamedCount& counter : usage_()) {
      health.counters.push_back(std::move(counter));
    }
  }
  health.loops = loops_;
  health.loop_worst_s = loop_worst_s_;
  health.deadlines_missed = node_.deadlines_missed();
  fault_sum_reported_ = fault_sum();
  bus_.publish(health_channel(node_.name()), std::move(health));
  loop_worst_s_ = 0.0;
  next_on_change_ = now + kReportOnChangePeriod;
}

void run_node(Bus& bus, Node& node, const Clock& clock, const std::function<int()>& stop_requests,
              const Usage& usage, LivenessSender* life, const WaitCounter& wait_counter) {
  HealthReporter health(bus, node, usage);
  WaitReporter processor_wait(wait_counter);
  health.publish(clock.now(), models::ProcessState::kStarting);
  const auto give_sign = [&](Time now) {
    if (life != nullptr) {
      life->on_loop(now, node.in_flight(now));
    }
  };
  int requests_seen = 0;
  while (true) {
    const int requests = stop_requests();
    if (requests > requests_seen) {
      node.on_stop_request(requests, clock.now());
      requests_seen = requests;
    }
    if (requests_seen > 0 && node.may_end(clock.now())) {
      break;
    }
    Duration wait = std::clamp(node.next_tick() - clock.now(), Duration{0}, kStopPollPeriod);
    bool is_woken = false;
    if (node.wakes_on() >= 0) {
      is_woken = wait_for(node.wakes_on(), wait);
      wait = Duration{0};
    }
    const double handled_before_s = bus.handling_s();
    if (bus.handle(wait) == kSourceEnded) {
      break;
    }
    const std::int64_t tick_start_ns = monotonic_ns();
    const Time now = clock.now();
    processor_wait.report(node, now);
    if (is_woken || now >= node.next_tick()) {
      node.tick(now);
    }
    const double tick_s = static_cast<double>(monotonic_ns() - tick_start_ns) * 1e-9;
    health.on_loop(now, tick_s + bus.handling_s() - handled_before_s);
    give_sign(now);
  }
  give_sign(clock.now());
  health.publish(clock.now(), models::ProcessState::kStopping);
}

}  // namespace vantage::bus
