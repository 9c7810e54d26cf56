#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bus/convert/channels.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/latency_record.hpp"
#include "core/time.hpp"
#include "drivers/safety/limits.hpp"
#include "drivers/vehicle/driver_end.hpp"
#include "drivers/vehicle/port.hpp"
#include "models/exchange/counts.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Bus node of one vehicle of any type. It subscribes to VICON, PLAN_*, COMMAND and SCENARIO,
/// publishes VEHICLE_R at 10 Hz and on change, and reads its port at each tick. A derived class
/// passes received data to its driver and sends the output of the driver. Driver(scenario, robot,
/// limits, own) has on_plan, on_map, on_other_version, on_processor_wait, take_changed, status,
/// counters, end and end_facts.
///
/// When requested to end, the node first stops the vehicle and its motors (DriverEnd). After a
/// second request it only waits until the autopilot has confirmed its own landing mode.
///
/// `now` is the stack's time, which never decreases (bus::SteadyClock), so that setting a clock
/// causes no motion of a vehicle.
template <class Driver>
class VehicleNode : public bus::Node {
 public:
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override {
    next_tick_ = now + tick_period_;
    for (int i = 0; i < kReadsMax; ++i) {
      const std::size_t got = port_->read(buffer_, now);
      if (got == 0) {
        break;
      }
      if (receive({buffer_.data(), got}, now)) {
        port_->accept(now);
      }
    }
    if (const std::int64_t count = bus_.undecoded(); count != std::exchange(undecoded_, count)) {
      driver_.on_other_version(now);
    }
    act(now);
    if (driver_.take_changed() || now >= next_status_) {
      publish_status(now);
    }
  }
  void on_processor_wait(double wait_s) override { driver_.on_processor_wait(wait_s); }
  [[nodiscard]] std::vector<models::NamedCount> counters() const override {
    std::vector<models::NamedCount> out = driver_.counters();
    for (models::NamedCount& counter : port_->counters()) {
      out.push_back(std::move(counter));
    }
    models::append_latency(out, "latency.frame_heard", frame_latency_);
    models::append_latency(out, "latency.heard_setpoint", answer_latency_);
    models::append_latency(out, "latency.frame_setpoint", stack_latency_);
    return out;
  }
  void on_stop_request(int requests, Time now) override {
    end_.request(requests, now);
    driver_.end(end_.is_hurried());
  }
  [[nodiscard]] bool may_end(Time now) override {
    const bool was_hurried = end_.is_hurried();
    end_.step(driver_.end_facts(now), now);
    if (end_.is_hurried() != was_hurried) {
      driver_.end(true);
    }
    if (!end_.may_end()) {
      return false;
    }
    publish_status(now);  // publishes the final state
    return true;
  }
  [[nodiscard]] std::string end_fault() const override {
    return end_.fault().empty() ? "" : robot_ + ": " + end_.fault();
  }
  [[nodiscard]] InFlight in_flight(Time now) const override {
    return driver_.end_facts(now).in_flight;
  }

 protected:
  /// @param name  name of the process in HEALTH_<name>
  /// @param landing  time for the vehicle to stop when the driver is asked to shut down
  /// @param own   last argument of Driver, after scenario, robot and limits
  /// @param limits  nullopt: limits_for(scenario, robot)
  // Long function: it subscribes to all channels of a vehicle.
  template <class Own>
  VehicleNode(const std::string& name, Duration tick_period, Duration landing, bus::Bus& bus,
              const bus::Clock& clock, const scenario::Scenario& scenario, const std::string& robot,
              std::unique_ptr<Port> port, const Own& own,
              const std::optional<SafetyLimits>& limits = std::nullopt)
      : bus_(bus),
        clock_(clock),
        name_(name),
        robot_(robot),
        driver_(scenario, robot, limits ? *limits : limits_for(scenario, robot), own),
        port_(std::move(port)),
        tick_period_(tick_period),
        next_tick_(clock.now()),
        end_(next_tick_, landing) {
    // Several mocap systems or simulators may publish VICON; the driver selects one.
    bus::Channel<models::MocapFrame> vicon = bus::kVicon;
    vicon.is_shared = true;
    bus_.subscribe<models::MocapFrame>(vicon, [this](const models::MocapFrame& frame) {
      const Time now = clock_.now();
      on_mocap(frame, now);
      const Time answered = clock_.now();
      // An arrival time outside this range is not set, or is from another clock.
      if (frame.arrival <= now && frame.arrival >= now - kWayMax) {
        frame_latency_.add(now - frame.arrival);
        answer_latency_.add(answered - now);
        stack_latency_.add(answered - frame.arrival);
      }
    });
    // Several planners may publish on the channel of a robot; the driver selects one.
    bus::Channel<models::RobotPlan> plans = bus::plan_channel("*");
    plans.is_shared = true;
    bus_.subscribe<models::RobotPlan>(plans, [this](const models::RobotPlan& plan) {
      static_cast<void>(driver_.on_plan(plan, clock_.now()));  // the driver counts refusals
    });
    if constexpr (requires(Driver & driver, const models::VehicleStatus& status) {
                    driver.on_teammate_status(status, Time{});
                  }) {
      bus_.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"),
                                            [this](const models::VehicleStatus& status) {
                                              if (status.robot != robot_) {
                                                driver_.on_teammate_status(status, clock_.now());
                                              }
                                            });
    }
    bus_.act_as_vehicle(robot_);
    bus_.subscribe<models::OperatorCommand>(
        bus::kCommand, [this](const models::OperatorCommand& command) {
          on_command(command, clock_.now());
          // Arming starts a new session, so that earlier commands cannot be replayed to a vehicle
          // that may fly.
          if (command.action == models::OperatorAction::kArm &&
              (command.robot.empty() || command.robot == robot_)) {
            // The next status contains the new nonce, which commands must echo from now on.
            next_status_ = bus_.renew_session() ? Time{} : next_status_;
          }
        });
    // A second trial on the same network announces another scenario.
    bus::Channel<models::ScenarioNotice> maps = bus::kScenario;
    maps.lease = kMapLease;
    bus_.subscribe<models::ScenarioNotice>(
        maps, [this, text = scenario.source_text](const models::ScenarioNotice& notice) {
          driver_.on_map(notice.yaml == text);
        });
  }

  virtual void on_mocap(const models::MocapFrame& frame, Time now) = 0;
  virtual void on_command(const models::OperatorCommand& command, Time now) = 0;
  /// Processes bytes that the port has read. Returns true if the vehicle sent them.
  virtual bool receive(std::span<const std::uint8_t> bytes, Time now) = 0;
  /// Performs and sends all pending work.
  virtual void act(Time now) = 0;

  [[nodiscard]] Driver& driver() { return driver_; }
  [[nodiscard]] Port& port() { return *port_; }

 private:
  void publish_status(Time now) {
    next_status_ = now + kStatusPeriod;
    models::VehicleStatus status = driver_.status(now);
    status.stamp.time = now;
    bus_.publish(bus::vehicle_channel(robot_), std::move(status));
  }

  static constexpr Duration kStatusPeriod = std::chrono::milliseconds(100);
  /// time for which a publisher of SCENARIO stays accepted; it publishes every 5 s
  static constexpr Duration kMapLease = std::chrono::seconds(12);
  /// longest plausible time from a frame's arrival at the stack to its arrival here
  static constexpr Duration kWayMax = std::chrono::seconds(10);
  /// maximum reads per tick: a flood of data must not delay the vehicle
  static constexpr int kReadsMax = 64;

  bus::Bus& bus_;
  const bus::Clock& clock_;
  std::string name_;
  std::string robot_;
  Driver driver_;
  std::unique_ptr<Port> port_;
  Duration tick_period_;
  Time next_tick_;
  Time next_status_{};
  DriverEnd end_;
  std::int64_t undecoded_ = 0;
  /// latency from a frame's arrival at the stack to its arrival here
  LatencyRecord frame_latency_;
  /// latency from a frame's arrival here to the sending of the resulting messages
  LatencyRecord answer_latency_;
  LatencyRecord stack_latency_;  ///< sum of the two latencies
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace vantage::drivers
