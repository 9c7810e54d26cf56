#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/auth/envelope.hpp"
#include "test/bus/auth/auth_support.hpp"

// Tests signing and verification as pure functions.

namespace vantage::bus::auth {
namespace {

using Message = std::vector<std::uint8_t>;
using scenario::TrialMode;

constexpr Time kNow = Time{Duration{1'700'000'000'000'000}};
constexpr std::uint64_t kNowCounter = 1'700'000'000'000'000;
constexpr std::uint64_t kSession = 0x0123456789abcdef;

Message bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

Message from_hex(const std::string& hex) {
  Message out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    out.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return out;
}

/// A receiver with the keys of a trial.
struct Receiver {
  Keyring keyring;
  ReplayGuard replays;
  SignatureBudgets budgets;
  Expectation expectation{TrialMode::kLive, kNow};

  Refusal judge(const std::string& channel, Bytes message) {
    return verify(keyring, channel, message, expectation, replays, budgets).refusal;
  }
};

Receiver receiver_of(std::initializer_list<Role> roles) {
  Receiver receiver;
  for (const Role role : roles) {
    receiver.keyring.add(test::key_of(role, static_cast<std::uint8_t>(role)));
  }
  return receiver;
}

Message signed_by(const Key& key, const std::string& channel, const Message& payload,
                  std::uint64_t counter = kNowCounter, TrialMode mode = TrialMode::kLive,
                  std::uint64_t session = kSession, std::vector<Echo> echoes = {}) {
  Message message = payload;
  sign(key, channel, {key.id, session, counter, key.role, mode}, echoes, message);
  return message;
}

// The expected bytes were made by Python's hashlib.blake2b, with the code that
// docs/guide/security.md shows for other programs.
TEST(Sign, AgreesWithAnIndependentImplementation) {
  const Key key = test::key_of(Role::kMocap, 0);
  EXPECT_EQ(key.id, 0x5b595a32U);
  const Message payload = bytes_of("what the cameras saw");
  Message expected = payload;
  const Message trailer = from_hex(
      "9e8bb761f005c6a18c87794d1b9984b95b595a320123456789abcdef00060a24181e400001010000"
      "0176616e74616765");
  expected.insert(expected.end(), trailer.begin(), trailer.end());
  EXPECT_EQ(signed_by(key, "VICON", payload), expected);
}

// The expected command was signed with Ed25519 by OpenSSL.
TEST(Sign, SignsCommandsAsAnIndependentImplementationDoes) {
  const Key key = test::key_of(Role::kOperator, 0);
  const Message payload = bytes_of("land");
  Message expected = payload;
  const Message trailer = from_hex(
      "08dab748111122223333444449aae286a0cdbaf47d9460c07e8bcf08358232d1fccd18875f01bdff"
      "9e6b19c1aa47c32e5b576fe66fa923176419f3fe80fef25e595fb56204771d7d6ceac90e045c82c9"
      "23b6b5bdae3972b0672b80582e8728d1fedcba987654321000060a24181e4001040201010176616e"
      "74616765");
  expected.insert(expected.end(), trailer.begin(), trailer.end());
  EXPECT_EQ(destination_of("Q1"), 0x08dab748U);
  EXPECT_EQ(signed_by(key, "COMMAND", payload, 1'700'000'000'000'001, TrialMode::kWire,
                      0xfedcba9876543210, {{destination_of("Q1"), 0x1111222233334444}}),
            expected);
}

TEST(Verify, AcceptsSignedMessagesAndReturnsThePayload) {
  Receiver receiver = receiver_of({Role::kMocap, Role::kOperator});
  for (const auto& [role, channel] :
       {std::pair{Role::kMocap, "VICON"}, std::pair{Role::kOperator, "COMMAND"}}) {
    const Message payload = bytes_of("something");
    const Key key = test::key_of(role, static_cast<std::uint8_t>(role));
    const Message message = signed_by(key, channel, payload);
    const Verdict verdict = verify(receiver.keyring, channel, message, receiver.expectation,
                                   receiver.replays, receiver.budgets);
    EXPECT_EQ(verdict.refusal, Refusal::kNone) << name_of(verdict.refusal);
    EXPECT_EQ(Message(verdict.payload.begin(), verdict.payload.end()), payload);
  }
}

TEST(Verify, RefusesEveryFlippedBit) {
  std::mt19937_64 rng(20'261'123);
  for (const Role role : {Role::kMocap, Role::kPlanner, Role::kOperator}) {
    const std::string channel =
        role == Role::kMocap ? "VICON" : (role == Role::kPlanner ? "PLAN_Q1" : "COMMAND");
    const Key key = test::key_of(role, static_cast<std::uint8_t>(role));
    for (int round = 0; round < 3; ++round) {
      Message payload(rng() % 60);
      for (std::uint8_t& byte : payload) {
        byte = static_cast<std::uint8_t>(rng());
      }
      std::vector<Echo> echoes;
      if (role == Role::kOperator) {
        echoes = {{destination_of("Q1"), rng()}, {destination_of("Q2"), rng()}};
      }
      Message message =
          signed_by(key, channel, payload, kNowCounter, TrialMode::kLive, rng(), echoes);
      Receiver receiver = receiver_of({role});
      const Budget any(1e9, 1e9);
      receiver.budgets = SignatureBudgets({any, any}, {any, any}, {any, any});
      for (std::size_t bit = 0; bit < 8 * message.size(); ++bit) {
        message[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        ASSERT_NE(receiver.judge(channel, message), Refusal::kNone) << name_of(role) << ' ' << bit;
        message[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      }
      EXPECT_EQ(receiver.judge(channel, message), Refusal::kNone)
          << "no refused message was counted";
    }
  }
}

// An attacker with the MAC key, for example from a captured vehicle, changes bytes that the
// signature covers.
TEST(Verify, RefusesACommandWithAValidMacAndAWrongSignature) {
  const Key station = test::key_of(Role::kOperator, 4);
  Key captured = test::key_of(Role::kOperator, 4);
  std::vector<std::uint8_t> other_seed(kSeedBytes, 9);
  set_seed(captured, other_seed);  // the attacker's own key pair, with the true MAC key and id
  captured.id = station.id;
  Receiver receiver = receiver_of({Role::kOperator});
  EXPECT_EQ(receiver.judge("COMMAND", signed_by(captured, "COMMAND", bytes_of("arm"))),
            Refusal::kBadSignature);
  EXPECT_EQ(receiver.judge("COMMAND", signed_by(station, "COMMAND", bytes_of("arm"))),
            Refusal::kNone);
}

TEST(Verify, ReturnsTheReasonOfARefusal) {
  const Key mocap = test::key_of(Role::kMocap, 1);
  const Message payload = bytes_of("frame");
  Receiver receiver = receiver_of({Role::kMocap, Role::kPlanner, Role::kNode});
  EXPECT_EQ(receiver.judge("VICON", payload), Refusal::kUnsigned);
  EXPECT_EQ(receiver.judge("VICON", signed_by(test::key_of(Role::kMocap, 77), "VICON", payload)),
            Refusal::kUnknownKey);
  EXPECT_EQ(receiver.judge("VICON", signed_by(test::key_of(Role::kNode, 5), "VICON", payload)),
            Refusal::kWrongRole)
      << "the role of an estimator may not sign VICON";
  EXPECT_EQ(receiver.judge("VICON", signed_by(mocap, "VICON2", payload)), Refusal::kBadMac)
      << "signed for another channel";
  const Key planner = test::key_of(Role::kPlanner, 2);
  EXPECT_EQ(receiver.judge("PLAN_Q2", signed_by(planner, "PLAN_Q1", payload)), Refusal::kBadMac)
      << "signed for the plan of another robot";
  for (const TrialMode mode : {TrialMode::kWire, TrialMode::kSimulation, TrialMode::kReplay}) {
    EXPECT_EQ(receiver.judge("VICON", signed_by(mocap, "VICON", payload, kNowCounter, mode)),
              Refusal::kWrongMode)
        << name_of(mode);
  }
  const std::uint64_t apart = 2'000'001;
  for (const std::uint64_t counter :
       {kNowCounter - apart, kNowCounter + apart, std::uint64_t{1}, ~std::uint64_t{0}}) {
    EXPECT_EQ(receiver.judge("VICON", signed_by(mocap, "VICON", payload, counter)),
              Refusal::kStale);
  }
  EXPECT_EQ(receiver.judge("VICON", signed_by(mocap, "VICON", payload)), Refusal::kNone);
  EXPECT_EQ(receiver.judge("VICON", signed_by(mocap, "VICON", payload)), Refusal::kReplayed);
}

TEST(Verify, ReportsABadMacForAnotherKeyWithTheSameId) {
  Key forged = test::key_of(Role::kMocap, 50);
  forged.id = test::key_of(Role::kMocap, 1).id;
  Receiver receiver = receiver_of({Role::kMocap});
  EXPECT_EQ(receiver.judge("VICON", signed_by(forged, "VICON", bytes_of("x"))), Refusal::kBadMac);
}

TEST(Verify, AcceptsOldAndNewKeyDuringARotation) {
  Receiver receiver;
  for (const auto& [first, use] :
       {std::pair{1, KeyUse::kSigns}, std::pair{90, KeyUse::kNext}, std::pair{60, KeyUse::kOld}}) {
    Key key = test::key_of(Role::kMocap, static_cast<std::uint8_t>(first));
    key.use = use;
    receiver.keyring.add(std::move(key));
  }
  for (const int first : {1, 60, 90}) {
    const Key signing = test::key_of(Role::kMocap, static_cast<std::uint8_t>(first));
    EXPECT_EQ(receiver.judge("VICON", signed_by(signing, "VICON", bytes_of("frame"))),
              Refusal::kNone)
        << "each key has separate counters";
  }
}

// Counters are shuffled within less than the window and repeated at random. Each message is
// accepted once in any order; messages far older than the newest message are refused.
TEST(ReplayGuard, AcceptsEachMessageOnceWithinWindow) {
  std::mt19937_64 rng(7);
  for (int trial = 0; trial < 50; ++trial) {
    ReplayGuard guard;
    std::vector<std::uint64_t> counters;
    std::uint64_t counter = 1'000;
    for (int i = 0; i < 500; ++i) {
      counter += 1 + rng() % 50;
      counters.push_back(counter);
    }
    std::vector<std::uint64_t> order = counters;
    for (std::size_t i = 0; i + 20 < order.size(); i += 20) {
      std::shuffle(order.begin() + static_cast<std::ptrdiff_t>(i),
                   order.begin() + static_cast<std::ptrdiff_t>(i + 20), rng);
    }
    const std::uint64_t session = rng();
    for (std::size_t i = 0; i < order.size(); ++i) {
      ASSERT_TRUE(guard.admit(1, session, order[i]));
      ASSERT_FALSE(guard.admit(1, session, order[rng() % (i + 1)])) << "received before";
      ASSERT_TRUE(guard.admit(2, session, order[i])) << "another key";
    }
    for (const std::uint64_t old : counters) {
      ASSERT_FALSE(guard.admit(1, session, old));
    }
  }
}

TEST(ReplayGuard, RefusesNumbersThatWereSkippedLongAgo) {
  ReplayGuard guard;
  for (std::uint64_t counter = 100; counter < 100 + 2 * ReplayGuard::kWindow; ++counter) {
    ASSERT_TRUE(guard.admit(1, 1, counter));
  }
  EXPECT_FALSE(guard.admit(1, 1, 99));
}

TEST(ReplayGuard, ReplacesTheLongestSilentSession) {
  ReplayGuard guard;
  ASSERT_TRUE(guard.admit(1, 0, 5));
  for (std::uint64_t session = 1; session < ReplayGuard::kSessionsMax; ++session) {
    ASSERT_TRUE(guard.admit(1, session, 5));
  }
  ASSERT_FALSE(guard.admit(1, 0, 5))
      << "all sessions are remembered; this one sent the last message";
  ASSERT_TRUE(guard.admit(1, 9'999, 5));
  EXPECT_TRUE(guard.knows(1, 0));
  EXPECT_FALSE(guard.knows(1, 1));
}

TEST(Echoes, IdentifyVehicleAndSessionOfACommand) {
  const Key station = test::key_of(Role::kOperator, 4);
  const std::uint32_t q1 = destination_of("Q1");
  const std::uint32_t q2 = destination_of("Q2");
  const Message message = signed_by(station, "COMMAND", bytes_of("arm"), kNowCounter,
                                    TrialMode::kLive, kSession, {{q1, 11}, {q2, 22}});
  const SignedParts parts = split(message).value();
  const std::array<std::uint64_t, 2> of_q1{11, 10};
  EXPECT_EQ(judge_echo(parts, q1, of_q1), Refusal::kNone);
  EXPECT_EQ(judge_echo(parts, q2, of_q1), Refusal::kWrongSession);
  EXPECT_EQ(judge_echo(parts, destination_of("Q3"), of_q1), Refusal::kWrongDestination);
}

// An attacker with the operator's MAC key floods the receiver with commands.
TEST(SignatureBudgets, LimitTheCostOfForgedCommandsAndKeepStopsPossible) {
  const Key station = test::key_of(Role::kOperator, 4);
  Key captured = test::key_of(Role::kOperator, 4);
  set_seed(captured, std::vector<std::uint8_t>(kSeedBytes, 9));
  captured.id = station.id;
  Receiver receiver = receiver_of({Role::kOperator});
  ASSERT_EQ(receiver.judge("COMMAND", signed_by(station, "COMMAND", bytes_of("beat"), kNowCounter)),
            Refusal::kNone);
  int verified = 0;
  std::uint64_t counter = kNowCounter;
  for (int i = 0; i < 20'000; ++i) {  // all within 2 s
    receiver.expectation.now = kNow + Duration{100} * i;
    const std::uint64_t session = i % 2 == 0 ? kSession : static_cast<std::uint64_t>(i);
    const Refusal refusal = receiver.judge(
        "COMMAND",
        signed_by(captured, "COMMAND", bytes_of("arm"), ++counter, TrialMode::kLive, session));
    ASSERT_TRUE(refusal == Refusal::kBadSignature || refusal == Refusal::kOverBudget);
    verified += refusal == Refusal::kBadSignature ? 1 : 0;
  }
  EXPECT_LE(verified, 50 + 200 + 20 + 40 + 2) << "at most 13 ms of work for each message";
  receiver.expectation.is_emergency_stop = true;
  EXPECT_EQ(receiver.judge("COMMAND", signed_by(station, "COMMAND", bytes_of("stop"), ++counter)),
            Refusal::kNone);
}

// Signature checks allowed at once, and added per 0.1 s, by kind of sender and of command.
TEST(SignatureBudgets, HaveTheStatedBurstAndRate) {
  enum class Asker { kProven, kOneHost, kManyHosts };
  struct Row {
    Asker asker;
    bool is_stop;
    int at_once;
    int in_a_tenth;
  };
  for (const Row& row :
       {Row{Asker::kProven, false, 50 + 10, 10 + 1},  // sender's budget plus that of its host
        Row{Asker::kProven, true, 50 + 20, 10 + 2}, Row{Asker::kOneHost, false, 10, 1},
        Row{Asker::kOneHost, true, 20, 2}, Row{Asker::kManyHosts, false, 40, 4},
        Row{Asker::kManyHosts, true, 50, 10}}) {
    SignatureBudgets budgets;
    if (row.asker == Asker::kProven) {
      budgets.add_verified({std::uint64_t{1} << 16U, 7}, kNow);
    }
    std::uint64_t host = 1;
    const auto taken = [&](Time now) {
      int out = 0;
      for (int i = 0; i < 300; ++i) {
        host += row.asker == Asker::kManyHosts ? 1 : 0;
        out += budgets.take({host << 16U, 7}, row.is_stop, now) ? 1 : 0;
      }
      return out;
    };
    EXPECT_EQ(taken(kNow), row.at_once) << static_cast<int>(row.asker) << ' ' << row.is_stop;
    EXPECT_EQ(taken(kNow), 0);
    EXPECT_EQ(taken(kNow + Duration{100'000}), row.in_a_tenth)
        << static_cast<int>(row.asker) << ' ' << row.is_stop;
  }
}

/// An attacker that has the operator's MAC key, taken from a captured vehicle, but not its signing
/// seed.
struct Attack {
  explicit Attack(const Key& station) : captured(test::key_of(Role::kOperator, 4)) {
    set_seed(captured, std::vector<std::uint8_t>(kSeedBytes, 9));
    captured.id = station.id;
  }
  /// Sends one forged stop or order from `source`; returns whether its signature was checked.
  bool send_forged(Receiver& receiver, bool is_stop, std::uint64_t source, std::uint64_t session) {
    receiver.expectation.is_emergency_stop = is_stop;
    receiver.expectation.source = source;
    const Refusal refusal = receiver.judge(
        "COMMAND",
        signed_by(captured, "COMMAND", bytes_of("x"), ++counter, TrialMode::kLive, session));
    EXPECT_TRUE(refusal == Refusal::kBadSignature || refusal == Refusal::kOverBudget);
    return refusal == Refusal::kBadSignature;
  }
  Key captured;
  std::uint64_t counter = kNowCounter;
};

/// Sends one operator command per 0.1 s for 1 s from `source` during a flood; returns the number of
/// accepted ones.
int accepted_during_flood(Receiver& receiver, const Key& station, bool is_stop,
                          std::uint64_t source, const std::function<void()>& flood) {
  int accepted = 0;
  for (int i = 0; i < 10'000; ++i) {
    receiver.expectation.now += Duration{100};
    flood();
    if (i % 1'000 == 999) {
      receiver.expectation.is_emergency_stop = is_stop;
      receiver.expectation.source = source;
      const auto command = signed_by(station, "COMMAND", bytes_of("word"),
                                     kNowCounter + 1'000'000 + static_cast<std::uint64_t>(i));
      accepted += receiver.judge("COMMAND", command) == Refusal::kNone ? 1 : 0;
    }
  }
  return accepted;
}

constexpr std::uint64_t kStation = (std::uint64_t{0x0a000001} << 16U) | 40'000U;  // 10.0.0.1:40000
constexpr std::uint64_t kAttacker = (std::uint64_t{0x0a000002} << 16U) | 40'000U;

/// Result of one second of forged commands: the number of accepted operator commands and the number
/// of signature checks of forged ones. `is_known`: the receiver has verified the operator before.
struct Flooded {
  int accepted = 0;
  int verified = 0;
};
Flooded flooded(bool is_stop, bool is_known,
                const std::function<bool(Attack&, Receiver&)>& send_forged) {
  const Key station = test::key_of(Role::kOperator, 4);
  Receiver receiver = receiver_of({Role::kOperator});
  Attack attack(station);
  if (is_known) {
    receiver.expectation.source = kStation;
    receiver.expectation.echoes_current_nonce = true;
    EXPECT_EQ(
        receiver.judge("COMMAND", signed_by(station, "COMMAND", bytes_of("beat"), kNowCounter)),
        Refusal::kNone);
  }
  Flooded out;
  out.accepted = accepted_during_flood(receiver, station, is_stop, kStation, [&] {
    out.verified += send_forged(attack, receiver) ? 1 : 0;
  });
  return out;
}

TEST(SignatureBudgets, FloodFromAnotherHostDelaysNoCommand) {
  for (const bool is_stop : {false, true}) {
    const Flooded out = flooded(is_stop, true, [&](Attack& attack, Receiver& receiver) {
      return attack.send_forged(receiver, is_stop, kAttacker, kSession);
    });
    EXPECT_EQ(out.accepted, 10) << is_stop;
    EXPECT_LE(out.verified, 20 + 20) << "one host causes at most 2 ms of work per second";
  }
}

// The attacker also sends from forged source addresses.
TEST(SignatureBudgets, FloodFromForgedAddressesDelaysNoKnownStation) {
  for (const bool is_stop : {false, true}) {
    std::mt19937_64 rng(7);
    const Flooded out = flooded(is_stop, true, [&](Attack& attack, Receiver& receiver) {
      const std::uint64_t session = rng() % 2 == 0 ? kSession : rng();
      return attack.send_forged(receiver, is_stop, rng() >> 16U, session);
    });
    EXPECT_EQ(out.accepted, 10) << is_stop;
    EXPECT_LE(out.verified, 50 + 100)
        << "all unknown senders cause at most 7 ms of work per second";
  }
}

TEST(SignatureBudgets, NewStationIsAcceptedDuringAnotherHostsFlood) {
  for (const bool is_stop : {false, true}) {
    std::mt19937_64 rng(8);
    const Flooded out = flooded(is_stop, false, [&](Attack& attack, Receiver& receiver) {
      const std::uint64_t source = kAttacker + rng() % 1'000;
      return attack.send_forged(receiver, is_stop, source, rng());
    });
    EXPECT_EQ(out.accepted, 10) << is_stop;
  }
}

// An attacker without a key replays the operator's messages.
TEST(SignatureBudgets, AreNotUsedUpByReplayedMessages) {
  const Key station = test::key_of(Role::kOperator, 4);
  Receiver receiver = receiver_of({Role::kOperator});
  const Message beat = signed_by(station, "COMMAND", bytes_of("beat"), kNowCounter);
  ASSERT_EQ(receiver.judge("COMMAND", beat), Refusal::kNone);
  for (int i = 0; i < 1'000; ++i) {
    ASSERT_EQ(receiver.judge("COMMAND", beat), Refusal::kReplayed);
  }
  EXPECT_EQ(
      receiver.judge("COMMAND", signed_by(station, "COMMAND", bytes_of("beat"), kNowCounter + 1)),
      Refusal::kNone);
}

TEST(Split, StaysWithinItsInput) {
  std::mt19937_64 rng(3);
  const Key key = test::key_of(Role::kOperator, 4);
  for (int i = 0; i < 20'000; ++i) {
    Message message = signed_by(key, "COMMAND", bytes_of("x"), 5, TrialMode::kLive, 1,
                                std::vector<Echo>(rng() % 4));
    for (std::size_t n = rng() % 4; n > 0; --n) {
      message[rng() % message.size()] = static_cast<std::uint8_t>(rng());
    }
    if (rng() % 2 == 0) {
      message.erase(message.begin(),
                    message.begin() + static_cast<std::ptrdiff_t>(rng() % message.size()));
    }
    const auto parts = split(message);
    if (parts) {
      ASSERT_EQ(parts->payload.size() + parts->echoes.size() + parts->signature.size() +
                    parts->mac.size() + parts->foot_bytes.size(),
                message.size());
    }
  }
  EXPECT_FALSE(split({}).has_value());
}

TEST(Policy, CriticalChannelsMustBeSigned) {
  for (const char* channel :
       {"VICON", "COMMAND", "PLAN_Q1", "PROPOSAL_Q1", "TEAM_PROPOSAL_Q1", "EXTERNAL_REQUEST_Q1",
        "EXTERNAL_PLAN_Q1", "VEHICLE_Q1", "MEASUREMENT_Q1", "SCAN_Q1", "BELIEF_Q1", "MIXTURE_Q1",
        "MAP_Q1", "ATTACK", "SCENARIO", "TRUTH", "HEALTH_PLANNER_Q1", "HOST_A", "COLLISION"}) {
    EXPECT_TRUE(must_be_signed(channel)) << channel;
  }
  for (const char* channel : {"CAMERA", "", "REPLAY_VICON", "VICONS", "HOST", "COLLISIONS"}) {
    EXPECT_FALSE(must_be_signed(channel)) << channel;
  }
}

}  // namespace
}  // namespace vantage::bus::auth
