// Node that receives beliefs and publishes its own belief every second. Needs component bus.
// Default URL: $LCM_DEFAULT_URL. `bus_node memq:// 3` receives its own beliefs.
#include <cstdio>
#include <cstdlib>

#include <vantage/bus/node/node.hpp>

using namespace vantage;

class Listener : public bus::Node {
 public:
  Listener(bus::Bus& bus, const bus::Clock& clock) : bus_(bus), next_(clock.now()) {
    bus_.subscribe<models::RobotBelief>(
        bus::belief_channel("*"), [this](const models::RobotBelief& belief) {
          std::printf("%s: beliefs of %zu targets\n", belief.robot.c_str(), belief.targets.size());
          ++received_;
        });
  }
  std::string name() const override { return "LISTENER"; }
  Time next_tick() const override { return next_; }
  void tick(Time now) override {
    bus_.publish(bus::belief_channel("LISTENER"), {.stamp = {now}, .robot = "LISTENER"});
    next_ += std::chrono::seconds(1);
  }
  int received() const { return received_; }

 private:
  bus::Bus& bus_;
  Time next_;
  int received_ = 0;
};

int main(int count, char** words) {
  const int beliefs = count > 2 ? std::atoi(words[2]) : 1'000'000;
  const auto transport = bus::open_transport(count > 1 ? words[1] : "");
  bus::Bus bus(*transport, bus::random_run_id());
  const bus::SteadyClock clock;
  Listener node(bus, clock);
  run_node(bus, node, clock, [&] { return node.received() >= beliefs; });
}
