#include "drivers/quadrotor/app/node.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "bus/channels.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(5);
constexpr Duration kStatusPeriod = std::chrono::milliseconds(100);
constexpr int kReadsMax = 64;  // in one tick: a flood must not keep set-points waiting

}  // namespace

std::optional<models::mavlink::SigningKey> load_key(const std::string& file) {
  if (file.empty()) {
    return std::nullopt;
  }
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in),
                                std::istreambuf_iterator<char>()};
  models::mavlink::SigningKey key{};
  if (bytes.size() != key.size()) {
    throw StartupError(file + ": a signing key is a file of 32 bytes, this one has " +
                       std::to_string(bytes.size()));
  }
  std::transform(bytes.begin(), bytes.end(), key.begin(),
                 [](char c) { return static_cast<std::uint8_t>(c); });
  return key;
}

QuadrotorNode::QuadrotorNode(bus::Bus& bus, const bus::Clock& clock,
                             const models::Scenario& scenario, const std::string& robot,
                             std::unique_ptr<Port> port)
    : bus_(bus),
      clock_(clock),
      robot_(robot),
      driver_(
          scenario, robot, limits_for(scenario, robot),
          load_key(scenario.find_robot(robot) != nullptr && scenario.find_robot(robot)->autopilot
                       ? scenario.find_robot(robot)->autopilot->key_file
                       : "")),
      port_(std::move(port)),
      started_(clock.now()),
      started_ns_(monotonic_ns()),
      next_tick_(started_) {
  bus_.subscribe<models::MocapFrame>(bus::kVicon, [this](const models::MocapFrame& frame) {
    const Time now = steady_now();
    driver_.on_mocap(frame, now);
    send_output(now);
  });
  // Several planners may speak on one robot's channel; flight safety knows which one to heed.
  bus::Channel<models::RobotPlan> plans = bus::plan_channel("*");
  plans.is_shared = true;
  bus_.subscribe<models::RobotPlan>(
      plans, [this](const models::RobotPlan& plan) { driver_.on_plan(plan, steady_now()); });
  bus_.subscribe<models::OperatorCommand>(bus::kCommand,
                                          [this](const models::OperatorCommand& command) {
                                            const Time now = steady_now();
                                            driver_.on_command(command, now);
                                            driver_.tick(now);
                                            send_output(now);
                                          });
  bus_.subscribe<models::ScenarioNotice>(
      bus::kScenario, [this, own = scenario.source_text](const models::ScenarioNotice& notice) {
        driver_.on_map(notice.yaml == own);
      });
}

Time QuadrotorNode::steady_now() const {
  return clock_.is_real_time() ? started_ + Duration{(monotonic_ns() - started_ns_) / 1000}
                               : clock_.now();
}

void QuadrotorNode::tick(Time now) {
  next_tick_ = now + kTickPeriod;
  const Time steady = steady_now();
  for (int i = 0; i < kReadsMax; ++i) {
    const std::size_t got = port_->read(buffer_, steady);
    if (got == 0) {
      break;
    }
    driver_.receive({buffer_.data(), got}, port_->is_datagram(), steady);
  }
  driver_.tick(steady);
  send_output(steady);
  if (driver_.take_news() || steady >= next_status_) {
    next_status_ = steady + kStatusPeriod;
    publish_status(steady);
  }
}

void QuadrotorNode::send_output(Time now) {
  for (const WireMessage& message : driver_.take_output()) {
    port_->write(message, now);
  }
}

void QuadrotorNode::publish_status(Time now) {
  models::VehicleStatus status = driver_.status(now);
  status.stamp.time = clock_.now();
  bus_.publish(bus::quadrotor_channel(robot_), std::move(status));
}

std::vector<models::NamedCount> QuadrotorNode::counters() const {
  std::vector<models::NamedCount> out = driver_.counters();
  for (models::NamedCount& counter : port_->counters()) {
    out.push_back(std::move(counter));
  }
  return out;
}

}  // namespace vantage::drivers
