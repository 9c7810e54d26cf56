#include "sim/app/node.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "bus/channels.hpp"
#include "core/check.hpp"

namespace vantage::sim {
namespace {

constexpr Duration kTruthPeriod{50'000};
constexpr Duration kStatusPeriod{100'000};
constexpr Duration kCatchUpPause{1'000};

Time at_or_after(Time time, Duration period) {
  return from_utime((to_utime(time) + period.count() - 1) / period.count() * period.count());
}

models::Scenario checked(const models::Scenario& scenario) {
  const std::string cure = "; this simulator knows 'direct' devices (and leaves 'real' ones alone)";
  for (const models::RobotSpec& robot : scenario.robots) {
    if (robot.device == models::DeviceSource::kWire) {
      throw StartupError("robot " + robot.name + " asks for device 'wire'" + cure);
    }
  }
  if (scenario.mocap.device == models::DeviceSource::kWire) {
    throw StartupError("mocap asks for device 'wire'" + cure);
  }
  return scenario;
}

}  // namespace

SimNode::SimNode(bus::Bus& bus, const bus::Clock& clock, const models::Scenario& scenario)
    : bus_(bus),
      scenario_(checked(scenario)),
      world_(scenario_, scenario_.seed, clock.now()),
      next_capture_(world_.camera().capture_at_or_after(world_.time())),
      next_truth_(at_or_after(world_.time(), kTruthPeriod)),
      next_status_(at_or_after(world_.time(), kStatusPeriod)),
      last_tick_(world_.time() - Duration{1}),
      said_(world_.quadrotors().size()) {
  bus_.subscribe_named<models::RobotPlan>(
      bus::plan_channel("*"), [this](const std::string& channel, const models::RobotPlan& plan) {
        on_plan(channel, plan);
      });
  bus_.subscribe<models::OperatorCommand>(
      bus::kCommand, [this](const models::OperatorCommand& command) { world_.command(command); });
}

void SimNode::on_plan(const std::string& channel, const models::RobotPlan& plan) {
  if (channel != bus::plan_channel(plan.robot).name ||
      scenario_.find_robot(plan.robot) == nullptr) {
    ++misaddressed_;
    return;
  }
  const std::optional<PlanVerdict> verdict = world_.offer(plan);
  if (!verdict) {
    return;  // a real vehicle's business
  }
  switch (*verdict) {
    case PlanVerdict::kAccepted:
      break;
    case PlanVerdict::kNotFinite:
      ++not_finite_;
      break;
    case PlanVerdict::kDiscontinuous:
      ++discontinuous_;
      break;
    case PlanVerdict::kStale:
      ++stale_;
      break;
    case PlanVerdict::kNotFollowing:
      ++not_following_;
      break;
  }
}

Time SimNode::next_instant() const { return std::min({next_capture_, next_truth_, next_status_}); }

Time SimNode::next_tick() const {
  return std::max(next_instant() + world_.camera().latency(), last_tick_ + kCatchUpPause);
}

void SimNode::tick(Time now) {
  const Duration latency = world_.camera().latency();
  if (now > next_instant() + latency + world_.camera().period()) {
    ++late_ticks_;
  }
  for (int instants = 0; instants < kInstantsMax && next_instant() + latency <= now; ++instants) {
    publish_instant(next_instant());
  }
  if (next_instant() + latency <= now) {
    ++chunks_;
  }
  last_tick_ = now;
}

void SimNode::publish_instant(Time instant) {
  world_.advance_to(instant);
  for (models::ContactReport& contact : world_.take_contacts()) {
    bus_.publish(bus::kCollision, std::move(contact));
  }
  if (instant == next_truth_) {
    bus_.publish(bus::kTruth, world_.truth());
    next_truth_ += kTruthPeriod;
  }
  if (instant == next_capture_) {
    if (scenario_.mocap.device == models::DeviceSource::kDirect) {
      bus_.publish(bus::kVicon, world_.capture());
    }
    next_capture_ += world_.camera().period();
  }
  publish_statuses(instant, instant == next_status_);
  if (instant == next_status_) {
    next_status_ += kStatusPeriod;
  }
}

void SimNode::publish_statuses(Time instant, bool is_due) {
  for (std::size_t i = 0; i < said_.size(); ++i) {
    const Quadrotor& quadrotor = world_.quadrotors()[i];
    const std::int64_t round = quadrotor.course().round(instant);
    if (is_due || said_[i].state != quadrotor.state() || said_[i].round != round) {
      bus_.publish(bus::quadrotor_channel(quadrotor.name()), quadrotor.status(instant));
      said_[i] = {quadrotor.state(), round};
    }
  }
}

std::vector<models::NamedCount> SimNode::counters() const {
  const std::vector<models::NamedCount> all{
      {"sim.plans_not_finite", not_finite_},
      {"sim.plans_discontinuous", discontinuous_},
      {"sim.plans_stale", stale_},
      {"sim.plans_not_following", not_following_},
      {"sim.plans_misaddressed", misaddressed_},
      {"sim.late_ticks", late_ticks_},
      {"sim.catch_up_chunks", chunks_},
      {"sim.bodies_not_finite", world_.collisions().non_finite()},
      {"sim.contact_judges_differ", world_.collisions().disagreements()}};
  std::vector<models::NamedCount> counted;
  std::copy_if(all.begin(), all.end(), std::back_inserter(counted),
               [](const models::NamedCount& counter) { return counter.count != 0; });
  return counted;
}

}  // namespace vantage::sim
