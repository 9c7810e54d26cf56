#include "bus/auth/authenticator.hpp"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/bus/auth/auth_support.hpp"

// Tests authentication in one process, without a bus: which sessions an authenticator echoes, and
// how long it accepts nonces.

namespace vantage::bus::auth {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Message = std::vector<std::uint8_t>;

constexpr Time kNow = Time{Duration{1'700'000'000'000'000}};

std::unique_ptr<Authenticator> process() { return test::authenticator(test::keys_of_a_trial()); }

Message sent_message(Authenticator& process, const std::string& channel, Time now,
                     const std::string& robot = "") {
  Message message{1, 2, 3};
  process.seal(channel, robot, now, message);
  return message;
}

/// Splits a signed message into its parts.
SignedParts parts_of(const Message& message) { return split(message).value(); }

void receive_status(Authenticator& station, const std::string& robot, const Message& status,
                    Time now) {
  EXPECT_TRUE(station.judge("VEHICLE_" + robot, status, now).may_pass);
}

TEST(Authenticator, EchoesTheDestinationOrAllReceivedVehicles) {
  const auto station = process();
  std::map<std::string, std::uint64_t> sessions;
  for (const char* const robot : {"Q1", "Q2", "Q3"}) {
    const auto vehicle = process();
    sessions[robot] = vehicle->session();
    receive_status(*station, robot, sent_message(*vehicle, std::string("VEHICLE_") + robot, kNow),
                   kNow);
  }
  const Message to_all = sent_message(*station, "COMMAND", kNow);
  EXPECT_EQ(parts_of(to_all).echoes.size(), 3 * kEchoBytes);
  const Message to_one = sent_message(*station, "COMMAND", kNow, "Q2");
  EXPECT_EQ(parts_of(to_one).echoes.size(), kEchoBytes);
  EXPECT_EQ(parts_of(to_one).echo_for(destination_of("Q2")), sessions["Q2"]);
  for (const auto& [robot, session] : sessions) {
    EXPECT_EQ(parts_of(to_all).echo_for(destination_of(robot)), session) << robot;
  }
  EXPECT_EQ(parts_of(sent_message(*station, "COMMAND", kNow, "Q9")).echoes.size(), 0U);
  EXPECT_EQ(parts_of(sent_message(*station, "PLAN_Q1", kNow)).echoes.size(), 0U)
      << "a plan is not a command";
}

TEST(Authenticator, EchoesAtMostSixtyFourVehicles) {
  const auto station = process();
  for (int i = 0; i < 70; ++i) {
    const std::string robot = "Q" + std::to_string(i);
    const auto vehicle = process();
    receive_status(*station, robot, sent_message(*vehicle, "VEHICLE_" + robot, kNow), kNow);
    EXPECT_EQ(parts_of(sent_message(*station, "COMMAND", kNow)).echoes.size(),
              std::min<std::size_t>(static_cast<std::size_t>(i) + 1, 64) * kEchoBytes);
  }
}

// The silent, unknown vehicles may be vehicles of an earlier trial with the same keys.
TEST(Authenticator, EchoesNewVehiclesInsteadOfSilentOnes) {
  const auto station = process();
  const auto hear_at = [&](int i, Time now) {
    const std::string robot = "Q" + std::to_string(i);
    const auto vehicle = process();
    receive_status(*station, robot, sent_message(*vehicle, "VEHICLE_" + robot, now), now);
  };
  const auto echoes = [&](int i, Time now) {
    return parts_of(sent_message(*station, "COMMAND", now))
        .echo_for(destination_of("Q" + std::to_string(i)))
        .has_value();
  };
  for (int i = 0; i < 64; ++i) {
    hear_at(i, kNow + milliseconds(i));
  }
  const Time later = kNow + Authenticator::kNonceLease;
  hear_at(64, later);
  EXPECT_FALSE(echoes(64, later)) << "any of the known vehicles may still exist";
  hear_at(64, later + milliseconds(1));
  EXPECT_TRUE(echoes(64, later + milliseconds(1)));
  EXPECT_FALSE(echoes(0, later + milliseconds(1))) << "this vehicle has been silent longest";
  for (int i = 1; i < 64; ++i) {
    EXPECT_TRUE(echoes(i, later + milliseconds(1))) << i;
  }
}

TEST(Authenticator, CountersIncreaseWithTheClockAndNeverDecrease) {
  const auto node = process();
  std::uint64_t last = 0;
  for (const int at_ms : {0, 0, 5, -100, -100, 6}) {
    const Time now = kNow + milliseconds(at_ms);
    const std::uint64_t counter = parts_of(sent_message(*node, "MAP_Q1", now)).foot.counter;
    EXPECT_GE(counter, static_cast<std::uint64_t>(to_utime(now)));
    EXPECT_GT(counter, last);
    EXPECT_LE(counter, static_cast<std::uint64_t>(to_utime(kNow)) + 6'000) << "but not farther";
    last = counter;
  }
  EXPECT_EQ(parts_of(sent_message(*process(), "MAP_Q1", from_utime(-5))).foot.counter, 1U);
}

/// A vehicle Q1 that requires a nonce, and a station.
class Nonces : public ::testing::Test {
 protected:
  Nonces() { vehicle_->act_as_vehicle("Q1"); }
  Message status(Time now) { return sent_message(*vehicle_, "VEHICLE_Q1", now); }
  Refusal command(Time now) {
    const Message message = sent_message(*station_, "COMMAND", now, "Q1");
    return vehicle_->judge("COMMAND", message, now, Authenticator::CommandClaim{now}).echo;
  }
  std::unique_ptr<Authenticator> vehicle_ = process();
  std::unique_ptr<Authenticator> station_ = process();
};

TEST_F(Nonces, RemainAcceptedForOneSecondAfterANewSession) {
  EXPECT_EQ(command(kNow), Refusal::kWrongDestination);
  receive_status(*station_, "Q1", status(kNow), kNow);
  EXPECT_EQ(command(kNow), Refusal::kNone);
  vehicle_->renew_session(kNow + seconds(1));
  EXPECT_EQ(command(kNow + seconds(2)), Refusal::kNone);
  EXPECT_EQ(command(kNow + seconds(2) + Duration{1}), Refusal::kWrongSession);
  vehicle_->renew_session(kNow + seconds(3));
  EXPECT_EQ(command(kNow + seconds(3)), Refusal::kWrongSession)
      << "the session before the last one";
}

TEST_F(Nonces, AreTakenFromTheNewestStatus) {
  const Message old = status(kNow);
  const std::uint64_t old_session = vehicle_->session();
  vehicle_->renew_session(kNow);
  const std::uint64_t session = vehicle_->session();
  ASSERT_NE(session, old_session);
  const auto echoed_by = [](Authenticator& station, Time now) {
    return parts_of(sent_message(station, "COMMAND", now)).echo_for(destination_of("Q1"));
  };
  receive_status(*station_, "Q1", status(kNow + milliseconds(1)), kNow + milliseconds(1));
  EXPECT_EQ(echoed_by(*station_, kNow), session);
  for (const int at_ms : {500, 1'000}) {  // further statuses of the same session
    receive_status(*station_, "Q1", status(kNow + milliseconds(at_ms)), kNow + milliseconds(at_ms));
  }
  receive_status(*station_, "Q1", old, kNow + seconds(2));
  EXPECT_EQ(echoed_by(*station_, kNow), session) << "older than the received status";
  // The last status arrived at 1 s and is stamped 1 s ahead: its nonce is kept for two seconds.
  for (const bool is_over : {false, true}) {
    const auto station = test::authenticator(test::keys_of_a_trial());
    const auto other = process();
    for (const int at_ms : {500, 1'000}) {
      receive_status(*station, "Q1", status(kNow + milliseconds(at_ms + 1'000)),
                     kNow + milliseconds(at_ms));
    }
    const Time now = kNow + seconds(3) + Duration{is_over ? 1 : 0};
    receive_status(*station, "Q1", sent_message(*other, "VEHICLE_Q1", kNow + milliseconds(1'900)),
                   now);
    EXPECT_EQ(echoed_by(*station, now), is_over ? other->session() : session);
  }
}

TEST(Authenticator, CountsRefusalsOf1024ChannelsByName) {
  const auto node = process();
  const Message unsigned_message{1, 2, 3};
  const auto refuse = [&](int i) {
    const std::string channel = "PLAN_" + std::to_string(i);
    EXPECT_FALSE(node->judge(channel, unsigned_message, kNow).may_pass);
  };
  const auto counts = [&] {
    std::vector<models::NamedCount> list;
    node->count(list);
    std::map<std::string, std::int64_t> out;
    for (const models::NamedCount& each : list) {
      EXPECT_TRUE(out.emplace(each.name, each.count).second) << each.name;
    }
    return out;
  };
  for (int i = 0; i < 1'024; ++i) {
    refuse(i);
  }
  EXPECT_EQ(counts().size(), 1'024U);
  refuse(1'024);
  refuse(2'000);
  refuse(3);
  EXPECT_EQ(counts().size(), 1'025U);
  EXPECT_EQ(counts()["(other).unsigned"], 2);
  EXPECT_EQ(counts()["PLAN_3.unsigned"], 2);
  EXPECT_FALSE(node->refuse("PLAN_3", Refusal::kStale));
  EXPECT_EQ(counts()["PLAN_3.stale"], 1);
  EXPECT_FALSE(node->judge("VICON", unsigned_message, kNow).may_pass);
  EXPECT_EQ(counts()["VICON.unsigned"], 1) << "unknown names do not replace a fixed channel name";
  EXPECT_TRUE(node->judge("CAMERA", unsigned_message, kNow).may_pass) << "a display needs no key";
  EXPECT_EQ(counts().count("CAMERA.unsigned"), 0U);
}

}  // namespace
}  // namespace vantage::bus::auth
