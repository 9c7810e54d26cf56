#include "sim/app/node.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "models/exchange/counts.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "sim/app/wire_kinds.hpp"

namespace vantage::sim {
namespace {

constexpr Duration kTruthPeriod{50'000};
constexpr Duration kStatusPeriod{100'000};
constexpr Duration kAttackPeriod{1'000'000};
constexpr Duration kCatchUpPause{1'000};
constexpr Duration kExchangePeriod = WorldSimulation::kStep;
constexpr const char* kRemedy = ": run it with `vantage up`, or set device: direct";

Time at_or_after(Time time, Duration period) {
  return from_utime((to_utime(time) + period.count() - 1) / period.count() * period.count());
}

std::vector<std::unique_ptr<WireVehicle>> wires_of(const scenario::Scenario& scenario,
                                                   const bus::Clock& clock, Time start) {
  std::vector<std::unique_ptr<WireVehicle>> wires;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const scenario::RobotSpec& robot = scenario.robots[i];
    if (robot.device != scenario::DeviceSource::kWire) {
      continue;
    }
    if (!clock.is_real_time()) {
      throw StartupError("robot " + robot.name + " has device 'wire', which needs real time" +
                         kRemedy);
    }
    wires.push_back(make_wire_vehicle(scenario, i, start));
  }
  return wires;
}

std::unique_ptr<vicon::SocketServer> mocap_server_of(const scenario::MocapSpec& mocap,
                                                     const bus::Clock& clock) {
  if (mocap.device != scenario::DeviceSource::kWire) {
    return nullptr;
  }
  if (!clock.is_real_time()) {
    throw StartupError(std::string("mocap has device 'wire', which needs real time") + kRemedy);
  }
  vicon::ServerSettings settings;
  settings.protocol = mocap.protocol;
  settings.rate_hz = mocap.rate_hz;
  settings.block_bytes = static_cast<std::size_t>(mocap.block_bytes);
  settings.is_y_up = mocap.is_y_up();
  return std::make_unique<vicon::SocketServer>(settings, mocap.host, mocap.actual_port());
}

std::vector<Vehicle*> pointers_to(const std::vector<std::unique_ptr<WireVehicle>>& wires) {
  std::vector<Vehicle*> out;
  for (const auto& wire : wires) {
    out.push_back(wire.get());
  }
  return out;
}

std::unique_ptr<SimulatedLocalisation> localisation_of(bus::Bus& bus,
                                                       const scenario::Scenario& scenario,
                                                       Time start) {
  const auto spec = scenario::localizer_of(scenario);
  return spec && spec->simulation
             ? std::make_unique<SimulatedLocalisation>(bus, scenario, *spec, start)
             : nullptr;
}

vicon::EmulatedFrame emulated(const models::MocapFrame& frame, Time now) {
  vicon::EmulatedFrame out;
  out.number = static_cast<std::uint32_t>(frame.frame_number);
  out.captured = frame.stamp.time;
  out.latency_s = to_seconds(now - frame.stamp.time);  // measured latency, not the nominal latency
  out.bodies.reserve(frame.bodies.size());
  for (const models::MocapBody& body : frame.bodies) {
    out.bodies.push_back({body.name, body.world_from_body, body.occluded});
  }
  return out;
}

}  // namespace

SimNode::SimNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario)
    : bus_(bus),
      clock_(clock),
      scenario_(scenario),
      start_(clock.now()),
      wires_(wires_of(scenario_, clock, start_)),
      mocap_server_(mocap_server_of(scenario_.mocap, clock)),
      world_(scenario_, scenario_.seed, start_, pointers_to(wires_)),
      localisation_(localisation_of(bus, scenario_, start_)),
      lag_(wires_.empty() ? world_.camera().latency() : Duration{0}),
      truth_period_(scenario_.mocap.device == scenario::DeviceSource::kReal
                        ? world_.camera().period()
                        : kTruthPeriod),
      next_capture_(world_.camera().capture_at_or_after(world_.time())),
      next_truth_(at_or_after(world_.time(), truth_period_)),
      next_status_(at_or_after(world_.time(), kStatusPeriod)),
      next_exchange_(has_wire() ? at_or_after(world_.time(), kExchangePeriod) : Time::max()),
      last_tick_(world_.time() - Duration{1}),
      last_statuses_(world_.quadrotors().size()) {
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
    return;  // a `wire` or real vehicle: its driver follows the plan
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

Time SimNode::next_instant() const {
  const Time next = std::min({next_capture_, next_truth_, next_status_, next_exchange_});
  return localisation_ ? std::min(next, localisation_->next_instant()) : next;
}

Time SimNode::next_tick() const {
  Time due = next_instant() + lag_;
  if (!frames_.empty()) {
    due = std::min(due, frames_.front().arrival);
  }
  return std::max(due, last_tick_ + kCatchUpPause);
}

void SimNode::tick(Time now) {
  if (now > next_instant() + lag_ + world_.camera().period()) {
    ++late_ticks_;
  }
  for (int instants = 0; instants < kInstantsMax && next_instant() + lag_ <= now; ++instants) {
    publish_instant(next_instant());
  }
  if (next_instant() + lag_ <= now) {
    ++chunks_;
  }
  deliver_frames(now);
  serve_wires(now);
  last_tick_ = now;
}

void SimNode::publish_instant(Time instant) {
  world_.advance_to(instant);
  for (models::CollisionReport& contact : world_.take_contacts()) {
    bus_.publish(bus::kCollision, std::move(contact));
  }
  if (instant == next_truth_) {
    bus_.publish(bus::kTruth, world_.truth());
    next_truth_ += truth_period_;
  }
  if (instant == next_capture_) {
    if (scenario_.mocap.device != scenario::DeviceSource::kReal) {
      frames_.push_back(world_.capture());
      if (localisation_) {
        localisation_->hide(frames_.back(), world_.truth());
      }
      deliver_frames(instant + lag_);
    }
    next_capture_ += world_.camera().period();
  }
  if (localisation_) {
    localisation_->publish(instant, world_);
  }
  publish_statuses(instant, instant == next_status_);
  publish_attack(instant);
  if (instant == next_status_) {
    next_status_ += kStatusPeriod;
  }
  if (instant == next_exchange_) {
    next_exchange_ += kExchangePeriod;
  }
}

void SimNode::deliver_frames(Time now) {
  while (!frames_.empty() && frames_.front().arrival <= now) {
    if (mocap_server_) {
      mocap_server_->publish(emulated(frames_.front(), clock_.now()));
    } else {
      bus_.publish(bus::kVicon, std::move(frames_.front()));
    }
    frames_.pop_front();
  }
}

void SimNode::serve_wires(Time now) {
  for (const auto& wire : wires_) {
    wire->exchange(now);
  }
  if (mocap_server_) {
    mocap_server_->wait(std::chrono::nanoseconds(0));
  }
}

void SimNode::publish_statuses(Time instant, bool is_due) {
  for (std::size_t i = 0; i < last_statuses_.size(); ++i) {
    const Quadrotor& quadrotor = world_.quadrotors()[i];
    const std::int64_t round = quadrotor.course().round(instant);
    if (is_due || last_statuses_[i].state != quadrotor.state() ||
        last_statuses_[i].round != round) {
      bus_.publish(bus::vehicle_channel(quadrotor.name()), quadrotor.status(instant));
      last_statuses_[i] = {quadrotor.state(), round};
    }
  }
}

void SimNode::publish_attack(Time instant) {
  if (scenario_.attacks.empty()) {
    return;
  }
  models::AttackNotice notice;
  notice.stamp.time = instant;
  const double since_s = to_seconds(instant - start_);
  for (const scenario::AttackSpec& attack : scenario_.attacks) {
    if (since_s >= attack.from_s && since_s < attack.to_s) {
      notice.jammed.insert(notice.jammed.end(), attack.robots.begin(), attack.robots.end());
    }
  }
  std::sort(notice.jammed.begin(), notice.jammed.end());
  notice.jammed.erase(std::unique(notice.jammed.begin(), notice.jammed.end()), notice.jammed.end());
  if (!attack_ || attack_->jammed != notice.jammed || instant >= next_attack_) {
    bus_.publish(bus::kAttack, notice);
    next_attack_ = instant + kAttackPeriod;
    attack_ = std::move(notice);
  }
}

std::vector<models::NamedCount> SimNode::counters() const {
  std::vector<models::NamedCount> all{
      {"sim.plans_not_finite", not_finite_},
      {"sim.plans_discontinuous", discontinuous_},
      {"sim.plans_stale", stale_},
      {"sim.plans_not_following", not_following_},
      {"sim.plans_misaddressed", misaddressed_},
      {"sim.late_ticks", late_ticks_},
      {"sim.catch_up_chunks", chunks_},
      {"sim.bodies_not_finite", world_.collisions().non_finite()},
      {"sim.contact_judges_differ", world_.collisions().disagreements()}};
  if (mocap_server_) {
    all.push_back({"sim.mocap_frames_skipped", mocap_server_->frames_skipped()});
    all.push_back({"sim.mocap_send_errors", mocap_server_->send_errors()});
  }
  if (localisation_) {
    all.push_back({"sim.poses_misaddressed", localisation_->misaddressed()});
  }
  for (const auto& wire : wires_) {
    for (models::NamedCount& counter : wire->counters()) {
      all.push_back(std::move(counter));
    }
  }
  return models::nonzero(std::move(all));
}

}  // namespace vantage::sim
