#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "bus/node/command_claim.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/bus/convert/message_types.hpp"

// An attacker without keys replays recorded messages. The replay must not delay the operator's
// orders.

namespace vantage::bus::auth {
namespace {

using models::OperatorAction;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using Message = std::vector<std::uint8_t>;

constexpr Time kNow = Time{Duration{1'700'000'000'000'000}};
constexpr std::uint64_t kStation = (std::uint64_t{0x0a000001} << 16U) | 40'000U;
constexpr std::uint64_t kStranger = (std::uint64_t{0x0a000002} << 16U) | 40'000U;
constexpr int kRecorded = 10'764;
constexpr Duration kAttackPeriod = microseconds(400);

std::unique_ptr<Authenticator> process() {
  static const auto keys = test::keys_of_a_trial();
  return test::authenticator(keys);
}

Message command_of(Authenticator& station, Time now, OperatorAction action) {
  models::OperatorCommand command;
  command.stamp = {now, 77, to_utime(now)};
  command.action = action;
  Message message = test::encoded(command);
  station.seal("COMMAND", "", now, message);
  return message;
}

Message status_of(Authenticator& vehicle, Time now) {
  models::VehicleStatus status;
  status.stamp.time = now;
  status.robot = "Q1";
  Message message = test::encoded(status);
  vehicle.seal("VEHICLE_Q1", "", now, message);
  return message;
}

/// One message that the attacker sends, and the address from which it is sent.
struct Forged {
  std::string channel;
  Message message;
  std::uint64_t source = kStranger;
};

/// Returns kRecorded signed commands of `stations` earlier sessions, recorded ten minutes ago.
std::vector<Forged> recorded_commands(int stations) {
  constexpr std::array kActions{OperatorAction::kHeartbeat, OperatorAction::kArm,
                                OperatorAction::kLand, OperatorAction::kEmergencyStop};
  std::vector<Forged> out;
  const Time begin = kNow - minutes(10);
  const auto vehicle = process();
  for (int s = 0; s < stations; ++s) {
    const auto station = process();
    EXPECT_TRUE(station->judge("VEHICLE_Q1", status_of(*vehicle, begin), begin).may_pass);
    for (int i = 0; i < kRecorded / stations; ++i) {
      const auto action = kActions[static_cast<std::size_t>(i) % kActions.size()];
      out.push_back({"COMMAND", command_of(*station, begin + milliseconds(i), action)});
    }
  }
  return out;
}

std::vector<Forged> under_addresses(std::vector<Forged> all, int addresses) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].source = kStranger + ((i % static_cast<std::size_t>(addresses)) << 16U);
  }
  return all;
}

std::vector<Forged> under_the_stations_address(std::vector<Forged> all) {
  for (Forged& each : all) {
    each.source = kStation;
  }
  return all;
}

std::vector<Forged> recorded_statuses() {
  std::vector<Forged> out;
  for (int i = 0; i < kRecorded; ++i) {
    const auto vehicle = process();
    out.push_back({"VEHICLE_Q1", status_of(*vehicle, kNow - minutes(1) + milliseconds(i))});
  }
  return out;
}

std::vector<Forged> unsigned_names() {
  std::vector<Forged> out;
  for (int i = 0; i < kRecorded; ++i) {
    out.push_back({"VEHICLE_X" + std::to_string(i), {1, 2, 3}});
  }
  return out;
}

/// Returns the longest time between two accepted operator orders while the attacker sends one
/// message per kAttackPeriod. The operator sends one per 0.2 s. `repeats_now`: the attacker instead
/// repeats the operator's latest message, each time from a new address.
Duration longest_wait(const std::vector<Forged>& attack, bool repeats_now) {
  const auto vehicle = process();
  const auto station = process();
  vehicle->act_as_vehicle("Q1");
  Time accepted = kNow;
  Duration longest{};
  Message last_order;
  int sent = 0;
  const Time end = kNow + kAttackPeriod * kRecorded;
  for (Time now = kNow; now < end; now += kAttackPeriod, ++sent) {
    const Duration since = now - kNow;
    if (since % milliseconds(100) == Duration{}) {
      EXPECT_TRUE(station->judge("VEHICLE_Q1", status_of(*vehicle, now), now).may_pass);
    }
    if (since % milliseconds(200) == Duration{}) {
      last_order = command_of(*station, now, OperatorAction::kHeartbeat);
      const auto judged = vehicle->judge("COMMAND", last_order, now,
                                         claim_of("COMMAND", last_order, "Q1"), kStation);
      if (judged.may_pass && judged.echo == Refusal::kNone) {
        longest = std::max(longest, now - accepted);
        accepted = now;
      }
    }
    Forged forged = attack[static_cast<std::size_t>(sent) % attack.size()];
    if (repeats_now) {
      forged = {"COMMAND", last_order, kStranger + (static_cast<std::uint64_t>(sent) << 16U)};
    }
    for (Authenticator* const receiver : {vehicle.get(), station.get()}) {
      const auto claim = claim_of(forged.channel, forged.message, "Q1");
      const auto judged =
          receiver->judge(forged.channel, forged.message, now, claim, forged.source);
      EXPECT_FALSE(judged.may_pass && receiver == vehicle.get()) << forged.channel;
    }
  }
  return std::max(longest, end - accepted);
}

TEST(ReplayAttack, DelaysNoOperatorOrder) {
  struct Row {
    const char* name;
    std::function<std::vector<Forged>()> attack;
    bool repeats_now = false;
  };
  const std::vector<Row> rows{
      {"commands of one earlier session", [] { return recorded_commands(1); }},
      {"commands of 299 earlier sessions", [] { return recorded_commands(299); }},
      {"commands of 299 earlier sessions from a thousand addresses",
       [] { return under_addresses(recorded_commands(299), 1'000); }},
      {"commands of one earlier session from the station's address",
       [] { return under_the_stations_address(recorded_commands(1)); }},
      {"statuses of an earlier session of the vehicle", recorded_statuses},
      {"unsigned messages on ever new names", unsigned_names},
      {"repetitions of the operator's latest message", [] { return recorded_commands(1); }, true},
  };
  for (const Row& row : rows) {
    EXPECT_LE(longest_wait(row.attack(), row.repeats_now), milliseconds(200)) << row.name;
  }
}

// The attacker replays commands recorded in the same session of the station, from before the
// vehicle was armed.
TEST(ReplayAttack, DoesNotUseTheSignatureBudgetOfTheStation) {
  const auto vehicle = process();
  const auto station = process();
  vehicle->act_as_vehicle("Q1");
  std::vector<Message> recorded;
  EXPECT_TRUE(station->judge("VEHICLE_Q1", status_of(*vehicle, kNow), kNow).may_pass);
  for (int i = 0; i < 1'000; ++i) {
    recorded.push_back(command_of(*station, kNow + milliseconds(i), OperatorAction::kHeartbeat));
  }
  const Time now = kNow + seconds(30);
  vehicle->renew_session(now - seconds(20));
  EXPECT_TRUE(station->judge("VEHICLE_Q1", status_of(*vehicle, now), now).may_pass);
  for (const Message& message : recorded) {
    const auto judged =
        vehicle->judge("COMMAND", message, now, claim_of("COMMAND", message, "Q1"), kStation);
    EXPECT_FALSE(judged.may_pass);
  }
  std::vector<models::NamedCount> counts;
  vehicle->count(counts);
  ASSERT_EQ(counts.size(), 1U) << "no command is refused because the budget is spent";
  EXPECT_EQ(counts[0].name, "COMMAND.wrong_session");
  EXPECT_EQ(counts[0].count, 1'000);
}

// The network delayed an emergency stop by 5 s; its station has been verified before.
TEST(Authenticator, AcceptsALateStopOfAVerifiedStation) {
  for (const bool is_known : {false, true}) {
    const auto vehicle = process();
    const auto station = process();
    vehicle->act_as_vehicle("Q1");
    const auto passes = [&](const Message& message, Time now) {
      return vehicle->judge("COMMAND", message, now, claim_of("COMMAND", message, "Q1"), kStation)
          .may_pass;
    };
    if (is_known) {
      EXPECT_TRUE(passes(command_of(*station, kNow, OperatorAction::kHold), kNow));
    }
    const Message stop = command_of(*station, kNow + seconds(1), OperatorAction::kEmergencyStop);
    EXPECT_EQ(passes(stop, kNow + seconds(6)), is_known);
  }
}

TEST(Authenticator, ReportsTheClockOffsetOfRefusedStatuses) {
  const auto station = process();
  const auto vehicle = process();
  EXPECT_EQ(station->stale_ahead(kNow), std::nullopt);
  for (const Duration ahead :
       {Duration(minutes(-10)), Duration(minutes(5)), Duration(minutes(60))}) {
    EXPECT_FALSE(station->judge("VEHICLE_Q1", status_of(*vehicle, kNow + ahead), kNow).may_pass);
  }
  EXPECT_EQ(station->stale_ahead(kNow + seconds(1)), minutes(5));
  EXPECT_EQ(station->stale_ahead(kNow + seconds(2)), std::nullopt);
}

}  // namespace
}  // namespace vantage::bus::auth
