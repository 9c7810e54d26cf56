#include <bit>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/decision/local_search_session.hpp"
#include "test/planner/decision/team_instance.hpp"

// Tests of proposals: fingerprints of motions, stated gains, the preference between two proposals,
// and the end of a session.

namespace vantage::planner {
namespace {

constexpr std::int64_t kRound = 7;
constexpr Time kActivation{Duration{1'000'000}};
const std::vector<std::string> kTeam = {"Q1", "Q2", "Q3"};

// Returns the 64-bit FNV-1a hash of `bytes`, as published.
std::int64_t fnv1a(const std::vector<unsigned char>& bytes) {
  std::uint64_t hash = 14'695'981'039'346'656'037U;
  for (const unsigned char byte : bytes) {
    hash = (hash ^ byte) * 1'099'511'628'211U;
  }
  return std::bit_cast<std::int64_t>(hash);
}

void add_word(std::vector<unsigned char>& bytes, std::uint64_t word) {
  for (int i = 0; i < 8; ++i) {
    bytes.push_back(static_cast<unsigned char>(word >> (8 * i)));  // least significant byte first
  }
}

models::TeamChoice choice() {
  models::TeamChoice choice;
  choice.robot = "Q\xE9";
  choice.trajectory.start_time = kActivation;
  choice.trajectory.start = {1.25, -2.5, 3.0};
  choice.trajectory.height_m = 0.1;
  choice.trajectory.segments = {{{0.5, -0.25}, 1.5, 0.0}, {{0.75, 0.125}, 2.5, 0.3}};
  return choice;
}

// Each character and each number is one word of eight bytes, least significant first. A motion
// consists of start, height, and per segment speed, yaw rate, duration and deceleration.
TEST(Fingerprint, IsIndependentOfTheMachine) {
  std::vector<unsigned char> bytes;
  add_word(bytes, 'Q');
  add_word(bytes, 0xE9);
  for (const double number : {1.25, -2.5, 3.0, 0.1, 0.5, -0.25, 1.5, 0.0, 0.75, 0.125, 2.5, 0.3}) {
    add_word(bytes, std::bit_cast<std::uint64_t>(number));
  }
  EXPECT_EQ(fingerprint(choice()), fnv1a(bytes));
}

TEST(Fingerprint, DependsOnTeamOrderAndHovers) {
  models::TeamChoice first = choice();
  first.robot = "Q1";
  models::TeamChoice last = choice();
  last.robot = "Q3";
  last.trajectory.start.x_m = 9.0;
  std::vector<unsigned char> bytes;
  add_word(bytes, std::bit_cast<std::uint64_t>(fingerprint(first)));
  add_word(bytes, 0);
  add_word(bytes, std::bit_cast<std::uint64_t>(fingerprint(last)));
  EXPECT_EQ(fingerprint(kTeam, {first, last}), fnv1a(bytes));
  EXPECT_EQ(fingerprint(kTeam, {last, first}), fnv1a(bytes)) << "for any order of the choices";
  EXPECT_NE(fingerprint({"Q3", "Q2", "Q1"}, {first, last}), fnv1a(bytes));
}

TEST(Fingerprint, DependsOnMotionAndNotOnValue) {
  const std::vector<std::function<void(models::TeamChoice&)>> others = {
      [](auto& c) { c.robot = "Q1"; },
      [](auto& c) { c.trajectory.start.x_m *= -1.0; },
      [](auto& c) { c.trajectory.start.y_m *= -1.0; },
      [](auto& c) { c.trajectory.start.yaw_rad *= -1.0; },
      [](auto& c) { c.trajectory.height_m *= -1.0; },
      [](auto& c) { c.trajectory.segments[1].control.speed_mps += 1e-15; },
      [](auto& c) { c.trajectory.segments[1].control.yaw_rate_radps *= -1.0; },
      [](auto& c) { c.trajectory.segments[1].duration_s *= 2.0; },
      [](auto& c) { c.trajectory.segments[1].brake_mps2 *= 2.0; },
      [](auto& c) { std::swap(c.trajectory.segments[0], c.trajectory.segments[1]); },
      [](auto& c) { c.trajectory.segments.pop_back(); },
  };
  for (std::size_t i = 0; i < others.size(); ++i) {
    models::TeamChoice other = choice();
    others[i](other);
    EXPECT_NE(fingerprint(other), fingerprint(choice())) << i;
  }
  models::TeamChoice worth = choice();
  worth.information_nats = 3.0;
  worth.energy_nats = 2.0;
  EXPECT_EQ(fingerprint(worth), fingerprint(choice()));
}

// ---- Sessions ----

/// A candidate of Q2 that measures one static target with information m; its gain is log(1 + m)
/// nats.
struct Own {
  double m = 0.0;
  double cost = 0.0;
  double unshared = 0.0;
};

SessionSetup setup_of(const std::vector<Own>& own) {
  SessionSetup setup;
  setup.robots = kTeam;
  setup.robot = 1;
  setup.round = kRound;
  setup.activation = kActivation;
  setup.problem.horizon_steps = 1;
  setup.problem.targets.push_back(
      {{models::TargetKind::kStatic, 2, 0.0},
       {models::StateVector::Zero(2), models::StateMatrix::Identity(2, 2)}});
  setup.problem.candidates.resize(kTeam.size());
  for (const Own& each : own) {
    Candidate candidate;
    candidate.energy_cost = each.cost;
    candidate.unshared_nats = each.unshared;
    if (each.m > 0.0) {
      candidate.measurements = {{0, 1, {{each.m, 0.0, each.m}}}};
    }
    setup.problem.candidates[1].push_back(candidate);
    models::TeamChoice motion;
    motion.trajectory.start_time = kActivation;
    motion.trajectory.start.x_m = static_cast<double>(setup.own.size());
    setup.own.push_back(motion);
  }
  setup.candidate_of = [](const models::TeamChoice& of_mate) {
    Candidate effect;
    effect.energy_cost = of_mate.energy_nats;
    effect.unshared_nats = of_mate.information_nats;
    return effect;
  };
  return setup;
}

/// Returns a teammate's proposal with the value `value_nats` and a motion of the teammate,
/// displaced by `y_m`.
models::TeamProposal proposal_of(const std::string& robot, double value_nats, double y_m = 0.0) {
  models::TeamProposal proposal;
  proposal.stamp.time = kActivation;
  proposal.robot = robot;
  proposal.round = kRound;
  proposal.value_nats = value_nats;
  proposal.choices = {{robot, {kActivation, {0.0, y_m, 0.0}, 1.0, {}}, value_nats, 0.0}};
  proposal.history = {fingerprint(kTeam, proposal.choices)};
  return proposal;
}

TEST(StandAloneInformation, ExcludesCostAndUnsharedInformation) {
  const SessionSetup setup = setup_of({{3.0, 0.5, 0.25}});
  EXPECT_NEAR(information_alone(setup.problem, setup.problem.candidates[1][0]), std::log(4.0),
              1e-12);
}

TEST(LocalSearchSession, StatesStandAloneGainAndCost) {
  LocalSearchSession session(setup_of({{0.5, 0.0, 0.0}, {3.0, 0.5, 0.25}}));
  const auto proposal = session.improve(Deadline::never());
  ASSERT_TRUE(proposal);
  EXPECT_EQ(proposal->robot, "Q2");
  EXPECT_EQ(proposal->round, kRound);
  EXPECT_EQ(proposal->stamp.time, kActivation);
  EXPECT_NEAR(proposal->value_nats, std::log(4.0) + 0.25 - 0.5, 1e-12);
  ASSERT_EQ(proposal->choices.size(), 1U);
  EXPECT_EQ(proposal->choices[0].robot, "Q2");
  EXPECT_EQ(proposal->choices[0].trajectory.start.x_m, 1.0) << "the second candidate";
  EXPECT_NEAR(proposal->choices[0].information_nats, std::log(4.0) + 0.25, 1e-12);
  EXPECT_EQ(proposal->choices[0].energy_nats, 0.5);
  EXPECT_EQ(proposal->history, (std::vector<std::int64_t>{fingerprint(kTeam, proposal->choices)}));
  // The session evaluates the deletion and then the swap with the other candidate.
  EXPECT_TRUE(session.is_searching());
  EXPECT_FALSE(session.improve(Deadline::never()));
  EXPECT_FALSE(session.is_searching());
}

TEST(LocalSearchSession, HoversWhenNoMotionIsWorthItsCost) {
  LocalSearchSession session(setup_of({{0.0, 0.0, 0.0}, {0.5, 2.0, 0.0}}));
  EXPECT_TRUE(session.is_searching());
  EXPECT_FALSE(session.improve(Deadline::never()));
  EXPECT_FALSE(session.is_searching());
  EXPECT_FALSE(session.held());
}

// An increase in value by kLeastRise_nats is proposed; a smaller one is not.
TEST(LocalSearchSession, ProposesOnlyIncreasesOfAMicronatOrMore) {
  EXPECT_EQ(LocalSearchSession::kLeastRise_nats, 1e-6);
  LocalSearchSession below(setup_of({{std::expm1(0.9e-6), 0.0, 0.0}}));
  EXPECT_FALSE(below.improve(Deadline::never()));
  LocalSearchSession above(setup_of({{std::expm1(1.1e-6), 0.0, 0.0}}));
  EXPECT_TRUE(above.improve(Deadline::never()));
}

TEST(LocalSearchSession, RefusesProposalsWithAnotherTeamOrUnknownMotions) {
  for (const int robot : {-1, 3}) {
    SessionSetup setup = setup_of({});
    setup.robot = robot;
    EXPECT_THROW(LocalSearchSession{std::move(setup)}, UsageError) << robot;
  }
  SessionSetup last = setup_of({});
  last.robot = 2;
  EXPECT_NO_THROW(LocalSearchSession{std::move(last)});
  SessionSetup fewer = setup_of({{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}});
  fewer.own.pop_back();
  EXPECT_THROW(LocalSearchSession{std::move(fewer)}, UsageError);
}

// A session prefers the greater value, then the sender that is first in the team, then the lower
// fingerprint. It selects the same proposal for any order of arrival.
TEST(LocalSearchSession, KeepsTheSameProposalForAnyOrderOfArrival) {
  models::TeamProposal low = proposal_of("Q3", 1.0, 1.0);
  models::TeamProposal high = proposal_of("Q3", 1.0, 2.0);
  if (low.history.back() > high.history.back()) {
    std::swap(low, high);
  }
  const std::vector<std::pair<models::TeamProposal, models::TeamProposal>> pairs = {
      {proposal_of("Q3", 2.0), proposal_of("Q1", 1.0)},  // better, worse
      {proposal_of("Q1", 1.0), proposal_of("Q3", 1.0)},
      {low, high},
  };
  for (const auto& [better, worse] : pairs) {
    LocalSearchSession session(setup_of({}));
    EXPECT_TRUE(session.receive(worse));
    EXPECT_TRUE(session.receive(better));
    EXPECT_EQ(session.held()->history, better.history);
    EXPECT_FALSE(session.receive(worse));
    EXPECT_FALSE(session.receive(better));
    EXPECT_EQ(session.held()->history, better.history);
    EXPECT_EQ(session.held()->robot, better.robot);
  }
}

TEST(LocalSearchSession, ChecksRoundAndValidityOfProposals) {
  const LocalSearchSession session(setup_of({{1.0, 0.0, 0.0}}));
  const models::TeamProposal good = proposal_of("Q3", 1.0);
  const auto verdict = [&](const std::function<void(models::TeamProposal&)>& spoil) {
    models::TeamProposal spoilt = good;
    spoil(spoilt);
    return std::pair(session.belongs_to_round(spoilt), session.is_consistent(spoilt));
  };
  using Verdict = std::pair<bool, bool>;
  EXPECT_EQ(verdict([](auto&) {}), Verdict(true, true));
  EXPECT_EQ(verdict([](auto& p) { ++p.round; }), Verdict(false, true));
  EXPECT_EQ(verdict([](auto& p) { --p.round; }), Verdict(false, true));
  EXPECT_EQ(verdict([](auto& p) { p.stamp.time += Duration{1}; }), Verdict(false, true));
  EXPECT_EQ(verdict([](auto& p) { p.robot = "Q9"; }), Verdict(true, false));
  EXPECT_EQ(verdict([](auto& p) { p.value_nats = 0.0; }), Verdict(true, false));
  EXPECT_EQ(verdict([](auto& p) { p.value_nats = std::numeric_limits<double>::quiet_NaN(); }),
            Verdict(true, false));
  EXPECT_EQ(verdict([](auto& p) { p.history.clear(); }), Verdict(true, false));
  EXPECT_EQ(verdict([](auto& p) { p.history.push_back(1); }), Verdict(true, false));
  EXPECT_EQ(verdict([](auto& p) { p.history.insert(p.history.begin(), 1); }), Verdict(true, true));
  const auto with = [&](const std::string& robot, double x_m) {
    return verdict([&](auto& p) {
      models::TeamChoice more;
      more.robot = robot;
      more.trajectory.start_time = kActivation;
      more.trajectory.start.x_m = x_m;
      p.choices.push_back(more);
      p.history = {fingerprint(kTeam, p.choices)};
    });
  };
  EXPECT_EQ(with("Q2", 0.0), Verdict(true, true)) << "its own first motion";
  EXPECT_EQ(with("Q2", 5.0), Verdict(true, false)) << "an unknown motion";
  EXPECT_EQ(with("Q1", 5.0), Verdict(true, true));
  EXPECT_EQ(with("Q9", 5.0), Verdict(true, false));
}

// A history has at most 256 solutions; then a robot proposes no further solution.
TEST(LocalSearchSession, LimitsTheHistoryTo256) {
  for (const std::size_t before : {std::size_t{254}, std::size_t{255}}) {
    LocalSearchSession session(setup_of({{3.0, 0.0, 0.0}}));
    models::TeamProposal received = proposal_of("Q3", 1.0);
    for (std::size_t i = 0; i < before; ++i) {
      received.history.insert(received.history.begin(), static_cast<std::int64_t>(i));
    }
    ASSERT_TRUE(session.receive(received));
    EXPECT_EQ(session.is_searching(), before < 255);
    EXPECT_EQ(session.improve(Deadline::never()).has_value(), before < 255);
  }
}

// A proposal never returns to a solution of its own history.
TEST(LocalSearchSession, ProposesNoSolutionOfItsHistory) {
  for (const bool was_there : {false, true}) {
    LocalSearchSession session(setup_of({{3.0, 0.0, 0.0}}));
    models::TeamProposal received = proposal_of("Q3", 5.0);
    std::vector<models::TeamChoice> both = received.choices;
    both.push_back(setup_of({{3.0, 0.0, 0.0}}).own[0]);
    both.back().robot = "Q2";
    if (was_there) {
      received.history.insert(received.history.begin(), fingerprint(kTeam, both));
    }
    ASSERT_TRUE(session.receive(received));
    const auto proposal = session.improve(Deadline::never());
    ASSERT_EQ(proposal.has_value(), !was_there);
    if (proposal) {
      EXPECT_EQ(proposal->history,
                (std::vector<std::int64_t>{received.history.back(), fingerprint(kTeam, both)}));
      EXPECT_NEAR(proposal->value_nats, 5.0 + std::log(4.0), 1e-12)
          << "previous value plus the increase";
      EXPECT_EQ(proposal->choices.size(), 2U);
    }
  }
}

// Values are gains relative to the committed choices, which have value 0.
TEST(LocalSearchSession, BeginsFromCommittedChoices) {
  SessionSetup setup = setup_of({{3.0, 0.0, 0.0}});
  setup.committed = proposal_of("Q3", 5.0).choices;
  LocalSearchSession session(std::move(setup));
  ASSERT_TRUE(session.held());
  EXPECT_EQ(session.held()->robot, "Q2");
  EXPECT_EQ(session.held()->round, kRound);
  EXPECT_EQ(session.held()->stamp.time, kActivation);
  EXPECT_EQ(session.held()->value_nats, 0.0);
  EXPECT_EQ(session.held()->history, proposal_of("Q3", 5.0).history);
  const auto proposal = session.improve(Deadline::never());
  ASSERT_TRUE(proposal);
  EXPECT_NEAR(proposal->value_nats, std::log(4.0), 1e-12);
  EXPECT_EQ(proposal->history.size(), 2U);
}

// The best stand-alone candidate is the best addition to an empty choice. Then its deletion is
// evaluated; the other candidate is excluded by its bound without an oracle call. Each action of a
// session counts as at least one call.
TEST(LocalSearchSession, CountsCallsAndStopsBetweenThem) {
  LocalSearchSession session(setup_of({{1.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}));
  EXPECT_FALSE(session.improve(Deadline::nodes(0)));
  EXPECT_EQ(session.calls(), 0);
  EXPECT_TRUE(session.improve(Deadline::nodes(1)));
  EXPECT_EQ(session.calls(), 1);
  for (const std::int64_t calls : {2, 3}) {
    EXPECT_TRUE(session.is_searching());
    EXPECT_FALSE(session.improve(Deadline::nodes(1)));
    EXPECT_EQ(session.calls(), calls);
  }
  EXPECT_FALSE(session.is_searching());
  EXPECT_FALSE(session.improve(Deadline::never()));
  EXPECT_EQ(session.calls(), 3);
}

}  // namespace
}  // namespace vantage::planner
