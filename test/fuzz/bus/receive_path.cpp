#include "test/fuzz/bus/receive_path.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "bus/auth/authenticator.hpp"
#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/channel_pattern.hpp"
#include "bus/transport/transport.hpp"
#include "bus/transport/udpm_packet.hpp"
#include "bus/transport/udpm_reassembly.hpp"
#include "drivers/safety/guard.hpp"
#include "drivers/safety/limits.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/fuzz/bus/datagram_input.hpp"

namespace vantage::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr std::uint8_t kIsSigned = 0x80;

void promise(bool is_kept, const char* what) {
  if (!is_kept) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

/// A transport that delivers the datagrams of the harness.
class FedTransport : public bus::Transport {
 public:
  void subscribe(const std::string& channel, Handler handler) override {
    subscriptions_.emplace_back(channel, std::move(handler));
  }
  void unsubscribe(const std::string&) override {}
  bool publish(const std::string&, std::span<const std::uint8_t>) override { return true; }
  int handle(std::chrono::microseconds) override { return 0; }
  [[nodiscard]] bus::TransportStats stats() const override { return {}; }
  void feed(const std::string& channel, std::span<const std::uint8_t> bytes, std::uint64_t source) {
    bus::Payload payload(bytes);
    payload.source = source;
    for (const auto& [pattern, handler] : subscriptions_) {
      if (bus::channel_matches(pattern, channel)) {
        handler(channel, payload);
      }
    }
  }

 private:
  std::vector<std::pair<std::string, Handler>> subscriptions_;
};

scenario::Scenario lab() {
  scenario::Scenario out;
  out.name = "fuzzed";
  out.world.bounds = {{-4.0, -2.2}, {4.0, 2.2}};
  out.world.ceiling_m = 3.0;
  for (int i = 0; i < 2; ++i) {
    scenario::RobotSpec robot;
    robot.name = i == 0 ? "Q1" : "Q2";
    robot.start = {-2.0 + 2.0 * i, 0.0, 0.0};
    robot.height_m = 1.0;
    robot.limits = {1.0, 3.0, 2.0, 0.25};
    out.robots.push_back(robot);
  }
  return out;
}

/// A vehicle's bus and guard as in its driver's process, without the autopilot.
struct Vehicle {
  Vehicle() : bus(transport, 1), guard(scenario, "Q1", drivers::limits_for(scenario, "Q1")) {
    bus.secure(authenticator(keys), clock);
    bus.use_clock(clock);
    bus.act_as_vehicle("Q1");
    const auto shared = [](auto channel) {
      channel.is_shared = true;
      return channel;
    };
    bus.subscribe<models::MocapFrame>(shared(bus::kVicon), [this](const models::MocapFrame& frame) {
      ++handed_on;
      static_cast<void>(guard.on_mocap(frame, clock.now()));
    });
    bus.subscribe<models::RobotPlan>(shared(bus::plan_channel("*")),
                                     [this](const models::RobotPlan& plan) {
                                       ++handed_on;
                                       if (plan.robot == "Q1") {
                                         static_cast<void>(guard.on_plan(plan, clock.now()));
                                       } else {
                                         guard.on_teammate_plan(plan, clock.now());
                                       }
                                     });
    bus.subscribe<models::OperatorCommand>(
        bus::kCommand, [this](const models::OperatorCommand& command) {
          ++handed_on;
          static_cast<void>(guard.on_command(command, clock.now()));
        });
    bus.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"),
                                         [this](const models::VehicleStatus& status) {
                                           ++handed_on;
                                           guard.on_teammate_status(status, clock.now());
                                         });
  }
  void tick() {
    const drivers::GuardOutput out = guard.tick(clock.now());
    promise(out.setpoint.position_world_m.allFinite() &&
                out.setpoint.velocity_world_mps.allFinite() &&
                out.setpoint.acceleration_world_mps2.allFinite(),
            "set-points are finite");
    promise(!out.wants_armed || handed_on > 0, "nothing arms by itself");
  }

  bus::VirtualClock clock{kStart};
  std::shared_ptr<const bus::auth::Keyring> keys = keys_of_a_trial();
  FedTransport transport;
  bus::Bus bus;
  scenario::Scenario scenario = lab();
  drivers::FlightGuard guard;
  bus::auth::Authenticator trial{keys, {}};  ///< signs for the emulated processes of the trial
  bus::udpm::Reassembler reassembler{{.message_bytes_max = 4'096,
                                      .source_bytes_max = 16'384,
                                      .total_bytes_max = 65'536,
                                      .messages_max = 16}};
  std::int64_t handed_on = 0;
  int inputs = 0;
};

/// Returns the vehicle. It is reused, since its construction costs more than its use, and replaced
/// after 1000 inputs.
Vehicle& vehicle() {
  static std::unique_ptr<Vehicle> one;
  if (!one || ++one->inputs > 1'000) {
    one = std::make_unique<Vehicle>();
  }
  return *one;
}

void deliver(Vehicle& self, std::uint8_t control, const std::string& channel, Bytes message) {
  const std::int64_t before = self.handed_on;
  const bool is_signed = (control & kIsSigned) != 0 && channel.size() <= 255;
  if (is_signed) {
    self.trial.seal(channel, "", self.clock.now(), message);
  }
  self.transport.feed(channel, message, std::uint64_t{control & 15U} << 16U);
  promise(is_signed || self.handed_on == before, "what is not signed moves nothing");
}

void put_datagram(std::uint8_t control, const bus::udpm::PacketHead& head,
                  std::span<const std::uint8_t> payload, Bytes& input) {
  const std::size_t size = head.bytes().size() + payload.size();
  input.insert(input.end(), {control, static_cast<std::uint8_t>(size >> 8U),
                             static_cast<std::uint8_t>(size & 255U)});
  input.insert(input.end(), head.bytes().begin(), head.bytes().end());
  input.insert(input.end(), payload.begin(), payload.end());
}

template <class Message>
Bytes encoded_message(const Message& message) {
  const auto wire = bus::to_wire(message);
  Bytes out(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(out.data(), 0, wire.getEncodedSize());
  return out;
}

}  // namespace

void fuzz_receive_path(std::span<const std::uint8_t> input) {
  Vehicle& self = vehicle();
  while (const auto datagram = take_datagram(input)) {
    const std::uint8_t control = datagram->control;
    self.clock.set(self.clock.now() + Duration{10'000 * (1 + ((control >> 4U) & 7))});
    const std::int64_t now_ns = to_utime(self.clock.now()) * 1'000;
    if (const auto packet = bus::udpm::parse_packet(datagram->bytes)) {
      if (!packet->is_fragment) {
        deliver(self, control, std::string(packet->channel),
                {packet->payload.begin(), packet->payload.end()});
      } else if (auto whole = self.reassembler.add(control & 15U, *packet, now_ns)) {
        deliver(self, control, whole->channel, std::move(whole->payload));
      }
    }
    self.reassembler.expire(now_ns);
    promise(self.reassembler.bytes_kept() <= 65'536, "memory is bounded");
    self.tick();
  }
}

std::vector<std::vector<std::uint8_t>> receive_path_samples() {
  models::MocapFrame frame;
  frame.stamp = {kStart, 3, 1};
  frame.arrival = kStart;
  frame.bodies.push_back({"Q1", Pose3{}, false});
  models::RobotPlan plan;
  plan.stamp = {kStart, 4, 1};
  plan.robot = "Q1";
  models::OperatorCommand command;
  command.stamp = {kStart, 5, 1};
  command.action = models::OperatorAction::kArm;
  models::VehicleStatus status;
  status.stamp = {kStart, 6, 1};
  status.robot = "Q2";
  const std::vector<std::pair<std::string, Bytes>> messages{
      {"VICON", encoded_message(frame)},
      {"PLAN_Q1", encoded_message(plan)},
      {"COMMAND", encoded_message(command)},
      {"VEHICLE_Q2", encoded_message(status)}};
  std::vector<Bytes> samples;
  for (const std::uint8_t control : {std::uint8_t{1}, std::uint8_t{kIsSigned | 1}}) {
    Bytes all;
    for (const auto& [channel, message] : messages) {
      using bus::udpm::PacketHead;
      Bytes whole;
      put_datagram(control, PacketHead::of_short(1, channel), message, whole);
      const std::size_t half = message.size() / 2;
      const auto size = static_cast<std::uint32_t>(message.size());
      put_datagram(control, PacketHead::of_fragment(2, size, 0, 0, 2, channel),
                   std::span(message).first(half), whole);
      put_datagram(control,
                   PacketHead::of_fragment(2, size, static_cast<std::uint32_t>(half), 1, 2, ""),
                   std::span(message).subspan(half), whole);
      samples.push_back(whole);
      all.insert(all.end(), whole.begin(), whole.end());
    }
    samples.push_back(all);
  }
  return samples;
}

}  // namespace vantage::test
