#include "drivers/rover/app/node.hpp"

#include "bus/channels.hpp"
#include "core/deadline.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(20);
constexpr Duration kStatusPeriod = std::chrono::milliseconds(100);
constexpr int kReadsMax = 64;  // in one tick: a flood must not keep commands waiting

}  // namespace

RoverNode::RoverNode(bus::Bus& bus, const bus::Clock& clock, const models::Scenario& scenario,
                     const std::string& robot, std::unique_ptr<Port> port)
    : bus_(bus),
      clock_(clock),
      robot_(robot),
      driver_(scenario, robot, limits_for(scenario, robot),
              static_cast<std::uint32_t>(bus.run_id())),
      port_(std::move(port)),
      started_(clock.now()),
      started_ns_(monotonic_ns()),
      next_tick_(started_) {
  bus_.subscribe<models::MocapFrame>(bus::kVicon, [this](const models::MocapFrame& frame) {
    driver_.on_mocap(frame, steady_now());
  });
  // Several planners may speak on one robot's channel; the driver knows which one to heed.
  bus::Channel<models::RobotPlan> plans = bus::plan_channel("*");
  plans.is_shared = true;
  bus_.subscribe<models::RobotPlan>(plans, [this](const models::RobotPlan& plan) {
    (void)driver_.on_plan(plan, steady_now());  // counted there
  });
  bus_.subscribe<models::OperatorCommand>(
      bus::kCommand, [this](const models::OperatorCommand& command) {
        const Time now = steady_now();
        (void)driver_.on_command(command, now);  // counted there
        if (command.action != models::OperatorAction::kHeartbeat) {
          act(now);
        }
      });
  bus_.subscribe<models::ScenarioNotice>(
      bus::kScenario, [this, own = scenario.source_text](const models::ScenarioNotice& notice) {
        driver_.on_map(notice.yaml == own);
      });
}

Time RoverNode::steady_now() const {
  return clock_.is_real_time() ? started_ + Duration{(monotonic_ns() - started_ns_) / 1000}
                               : clock_.now();
}

void RoverNode::tick(Time now) {
  next_tick_ = now + kTickPeriod;
  const Time steady = steady_now();
  for (int i = 0; i < kReadsMax; ++i) {
    const std::size_t got = port_->read(buffer_, steady);
    if (got == 0) {
      break;
    }
    driver_.receive({buffer_.data(), got}, steady);
  }
  act(steady);
  if (driver_.take_news() || steady >= next_status_) {
    next_status_ = steady + kStatusPeriod;
    models::VehicleStatus status = driver_.status(steady);
    status.stamp.time = clock_.now();
    bus_.publish(bus::quadrotor_channel(robot_), std::move(status));
  }
}

void RoverNode::act(Time now) { port_->write(driver_.tick(now), now); }

std::vector<models::NamedCount> RoverNode::counters() const {
  std::vector<models::NamedCount> out = driver_.counters();
  for (models::NamedCount& counter : port_->counters()) {
    out.push_back(std::move(counter));
  }
  return out;
}

}  // namespace vantage::drivers
