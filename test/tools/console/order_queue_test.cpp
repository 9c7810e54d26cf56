#include "tools/console/order_queue.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/support/bus_pair.hpp"

namespace vantage::tools {
namespace {

using models::OperatorAction;
using Words = std::vector<std::string>;
constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// A console and the vehicles that receive its orders. The received orders are stored as text such
/// as "hold Q1", without heartbeats and repetitions.
class OrderQueueTest : public ::testing::Test {
 protected:
  OrderQueueTest() {
    vehicles_.subscribe<models::OperatorCommand>(
        bus::kCommand, [this](const models::OperatorCommand& command) {
          if (command.action == OperatorAction::kHeartbeat) {
            return;
          }
          const std::string word = word_of(command);
          stamps.push_back(command.stamp.time);
          if (std::find(received.begin(), received.end(), word) == received.end()) {
            received.push_back(word);
          }
        });
  }
  static std::string word_of(const models::OperatorCommand& command) {
    constexpr const char* kNames[] = {"beat", "arm", "take-off", "follow", "hold", "land", "estop"};
    return kNames[static_cast<std::size_t>(command.action)] +
           (command.robot.empty() ? "" : " " + command.robot);
  }
  void publish_status(const std::string& robot, Time stamp) {
    models::VehicleStatus status;
    status.robot = robot;
    status.stamp.time = stamp;
    vehicles_.publish(bus::vehicle_channel(robot), status);
  }
  /// Advances the time by `seconds`, during which `robots` publish their status.
  void pass(double seconds, const Words& robots = {"Q1", "Q2"}) {
    const Time end = now + from_seconds(seconds);
    while (now < end) {
      now += std::chrono::milliseconds(20);
      for (const std::string& robot : robots) {
        publish_status(robot, now + ahead);
      }
      if (hears_station) {
        models::OperatorCommand beat;
        beat.stamp.time = now;
        beat.action = OperatorAction::kHeartbeat;
        vehicles_.publish(bus::kCommand, beat);
      }
      net_.own.handle(std::chrono::microseconds(0));
      (void)sender_.tick(now);
      for (std::string& words : orders.tick(now)) {
        lines.push_back(std::move(words));
      }
      vehicles_.handle(std::chrono::microseconds(0));
    }
  }
  void add(OperatorAction action, const std::string& robot = "") {
    for (std::string& words : orders.add({action, robot}, now)) {
      lines.push_back(std::move(words));
    }
    vehicles_.handle(std::chrono::microseconds(0));
  }
  bool has_line(const std::string& words) const {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
      return line.find(words) != std::string::npos;
    });
  }

  Time now = kStart;
  Duration ahead{};
  bool hears_station = false;  ///< another station is in charge
  Words received;
  std::vector<Time> stamps;
  Words lines;

 private:
  test::BusPair net_{11, 13};
  bus::Bus& vehicles_ = net_.other;
  OrderSender sender_{net_.own, {}, kStart};

 protected:
  OrderQueue orders{sender_};
};

TEST_F(OrderQueueTest, SendsSafeOrdersAtOnceAndOthersWhenInCharge) {
  add(OperatorAction::kFollow, "Q2");
  add(OperatorAction::kHold, "Q1");
  EXPECT_EQ(received, Words{"hold Q1"});
  pass(0.6);
  EXPECT_EQ(received, Words{"hold Q1"});
  EXPECT_TRUE(orders.is_waiting());
  pass(0.3);
  EXPECT_EQ(received, (Words{"hold Q1", "follow Q2"}));
  EXPECT_FALSE(orders.is_waiting());
  EXPECT_FALSE(orders.was_refused());
  add(OperatorAction::kArm);
  EXPECT_EQ(received.back(), "arm");
}

// After `hold`, no vehicle begins to follow because of an earlier order.
TEST_F(OrderQueueTest, SaferOrderCancelsPendingOrders) {
  for (const OperatorAction safer :
       {OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    for (const std::string addressee : {"", "Q1"}) {
      add(OperatorAction::kArm, "Q1");
      add(OperatorAction::kFollow, "Q1");
      add(safer, addressee);
      EXPECT_FALSE(std::count(received.begin(), received.end(), "follow Q1"));
    }
  }
  pass(2.0);
  EXPECT_EQ(received, (Words{"hold", "hold Q1", "land", "land Q1", "estop", "estop Q1"}));
}

TEST_F(OrderQueueTest, PendingOrderToAllDoesNotUndoSaferOrderToOne) {
  add(OperatorAction::kFollow);
  add(OperatorAction::kLand, "Q1");
  add(OperatorAction::kFollow, "Q2");
  EXPECT_EQ(received, Words{"land Q1"});
  received.clear();
  pass(0.75);
  EXPECT_EQ(received, (Words{"land Q1", "follow"}));
  received.clear();
  pass(1.0);
  EXPECT_EQ(received, (Words{"land Q1", "follow Q2"})) << "the last order for Q1";
}

// A vehicle executes only the most urgent order of a tick: if `arm` and `take-off` arrived
// together, it would execute `take-off` only.
TEST_F(OrderQueueTest, SendsOneOrderPerTenthOfASecond) {
  pass(1.0);
  for (int round = 0; round < 2; ++round) {
    received.clear();
    add(OperatorAction::kArm);
    add(OperatorAction::kTakeOff);
    add(OperatorAction::kFollow);
    EXPECT_EQ(received, Words{"arm"});
    pass(0.08);
    EXPECT_EQ(received, Words{"arm"});
    pass(0.02);
    EXPECT_EQ(received, (Words{"arm", "take-off"}));
    pass(0.1);
    EXPECT_EQ(received, (Words{"arm", "take-off", "follow"}));
    pass(1.0);
  }
}

TEST_F(OrderQueueTest, SendsOrderToRobotThatPublishesLater) {
  add(OperatorAction::kEmergencyStop, "Q1");
  add(OperatorAction::kHold, "Q2");
  add(OperatorAction::kArm, "Q2");
  EXPECT_TRUE(orders.is_waiting());
  pass(2.0);
  EXPECT_EQ(received, (Words{"estop Q1", "hold Q2", "arm Q2"}));
  EXPECT_FALSE(orders.is_waiting());
  EXPECT_FALSE(orders.was_refused());
}

// Orders with typing errors are refused, except that an emergency stop must still work.
TEST_F(OrderQueueTest, RefusesUnknownRobotButStopsAllOnEmergencyStop) {
  add(OperatorAction::kEmergencyStop, "Q9");
  add(OperatorAction::kHold, "Q8");
  add(OperatorAction::kArm, "Q7");
  EXPECT_FALSE(orders.was_refused());
  pass(2.0);
  EXPECT_EQ(received, (Words{"estop Q9", "hold Q8", "estop"}));
  EXPECT_TRUE(has_line("no message received from robot 'Q8'"));
  EXPECT_TRUE(has_line("unknown robot 'Q7'"));
  EXPECT_TRUE(orders.was_refused());
  received.clear();
  add(OperatorAction::kEmergencyStop, "Q6");
  EXPECT_EQ(received, Words{"estop"}) << "immediately";
}

TEST_F(OrderQueueTest, SendsOrderBeforeAnyVehicleIsKnown) {
  add(OperatorAction::kLand);
  pass(1.0, {});
  add(OperatorAction::kArm, "Q1");
  pass(1.0, {});
  EXPECT_EQ(received, (Words{"land", "arm Q1"}));
  EXPECT_FALSE(orders.was_refused());
  add(OperatorAction::kLand, "q1");
  EXPECT_EQ(received.back(), "land q1");
  EXPECT_TRUE(orders.was_refused());
}

TEST_F(OrderQueueTest, RefusesOrderWhileAnotherStationIsInCharge) {
  hears_station = true;
  pass(1.0);
  add(OperatorAction::kHold, "Q9");
  add(OperatorAction::kHold, "Q1");
  add(OperatorAction::kArm, "Q1");
  EXPECT_EQ(received, Words{});
  EXPECT_FALSE(has_line("was sent anyway"));
  EXPECT_TRUE(has_line("not sent: refused"));
  EXPECT_TRUE(orders.was_refused());
  add(OperatorAction::kEmergencyStop, "Q9");
  EXPECT_EQ(received, Words{"estop"});
}

// Vehicles accept only orders with a current stamp by their own clock, which the console does not
// know at first.
TEST_F(OrderQueueTest, RestampsOrderOnceVehicleClockIsKnown) {
  ahead = std::chrono::hours(2);
  add(OperatorAction::kLand);
  ASSERT_EQ(stamps, std::vector<Time>{kStart});
  pass(2.0);
  ASSERT_EQ(stamps.size(), static_cast<std::size_t>(OrderSender::kTransmissions));
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    EXPECT_LE(std::chrono::abs(stamps[i] - (kStart + ahead)), std::chrono::milliseconds(20));
  }
}

}  // namespace
}  // namespace vantage::tools
