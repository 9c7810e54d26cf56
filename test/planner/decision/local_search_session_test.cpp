#include "planner/decision/local_search_session.hpp"

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/decision/distributed_local_search.hpp"
#include "test/planner/decision/team_instance.hpp"

namespace vantage::planner {
namespace {

constexpr std::uint64_t kInstances = 400;
constexpr double kRounding = 1e-9;
constexpr std::int64_t kRound = 7;
constexpr Time kActivation{Duration{1'000'000}};

// Returns the choice of candidate `id`. Candidates of a random team have no motion, so start.x_m
// contains the id.
models::TeamChoice choice_of(const TeamOracle& oracle, CandidateId id,
                             const std::vector<std::string>& robots) {
  models::TeamChoice choice;
  choice.robot = robots[index(oracle.robot_of(id))];
  choice.trajectory.start_time = kActivation;
  choice.trajectory.start.x_m = id;
  return choice;
}

// A session for each robot of a team. The robots have one common problem or separate problems.
class Team {
 public:
  // `problems` contains one problem for all robots, or one per robot with equal numbers of
  // candidates.
  explicit Team(std::vector<TeamProblem> problems) : problems_(std::move(problems)) {
    for (const TeamProblem& problem : problems_) {
      oracles_.emplace_back(problem);
    }
    const int robots = oracles_.front().robot_count();
    for (int robot = 0; robot < robots; ++robot) {
      names_.push_back("Q" + std::to_string(robot + 1));
    }
    for (int robot = 0; robot < robots; ++robot) {
      sessions_.push_back(session_of(robot));
    }
  }

  std::unique_ptr<LocalSearchSession> session_of(
      int robot, std::optional<std::vector<models::TeamChoice>> committed = std::nullopt) const {
    const TeamOracle& oracle = oracle_of(robot);
    SessionSetup setup;
    setup.robots = names_;
    setup.robot = robot;
    setup.round = kRound;
    setup.activation = kActivation;
    setup.committed = std::move(committed);
    setup.problem = oracle.problem();
    setup.problem.candidates.assign(names_.size(), {});
    setup.problem.candidates[index(robot)] = oracle.problem().candidates[index(robot)];
    for (CandidateId id = oracle.begin(robot); id < oracle.end(robot); ++id) {
      setup.own.push_back(choice_of(oracle, id, names_));
    }
    setup.candidate_of = [&oracle](const models::TeamChoice& choice) {
      return oracle.candidate(static_cast<CandidateId>(choice.trajectory.start.x_m));
    };
    return std::make_unique<LocalSearchSession>(std::move(setup));
  }

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] int size() const { return static_cast<int>(names_.size()); }
  [[nodiscard]] const TeamOracle& oracle_of(int robot) const {
    return oracles_.size() == 1 ? oracles_.front() : oracles_[index(robot)];
  }
  LocalSearchSession& operator[](int robot) { return *sessions_[index(robot)]; }
  [[nodiscard]] Choice choice_held_by(int robot) const {
    Choice choice(names_.size(), kNoCandidate);
    if (const auto& held = sessions_[index(robot)]->held()) {
      for (const models::TeamChoice& each : held->choices) {
        const auto id = static_cast<CandidateId>(each.trajectory.start.x_m);
        choice[index(oracle_of(robot).robot_of(id))] = id;
      }
    }
    return choice;
  }

 private:
  std::vector<TeamProblem> problems_;
  std::deque<TeamOracle> oracles_;  // one per problem
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<LocalSearchSession>> sessions_;
};

double value_of(const TeamOracle& oracle, const Choice& choice) {
  TeamSet fresh(oracle);
  fresh.become(choice);
  return fresh.value();
}

// Returns the largest increase in value by a deletion, an addition or a swap.
double largest_gain(const TeamOracle& oracle, const Choice& choice) {
  const double here = value_of(oracle, choice);
  double best = 0.0;
  for (int dropped = -1; dropped < oracle.robot_count(); ++dropped) {
    Choice less = choice;
    if (dropped >= 0) {
      less[index(dropped)] = kNoCandidate;
    }
    best = std::max(best, value_of(oracle, less) - here);
    for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
      Choice other = less;
      if (other[index(oracle.robot_of(id))] == kNoCandidate) {
        other[index(oracle.robot_of(id))] = id;
        best = std::max(best, value_of(oracle, other) - here);
      }
    }
  }
  return best;
}

// Random faults of a network. For each receiver a message is lost, or delivered once or twice with
// a delay.
struct Network {
  double lost = 0.0;
  double doubled = 0.0;
  int delay_max = 0;  ///< steps
};

struct Outcome {
  int proposals = 0;
  bool is_finished = false;
  std::vector<models::TeamProposal> sent;
};

// Runs the sessions in random order, `calls` oracle calls per step. Ends when no session searches
// and no message is in transit, or after `steps_max` steps.
Outcome run(Team& team, const Network& network, std::uint64_t seed, std::int64_t calls,
            int steps_max) {
  std::mt19937_64 rng(seed);
  const auto chance = [&] { return std::uniform_real_distribution(0.0, 1.0)(rng); };
  std::multimap<int, std::pair<int, models::TeamProposal>> under_way;
  Outcome out;
  for (int step = 0; step < steps_max; ++step) {
    while (!under_way.empty() && under_way.begin()->first <= step) {
      const auto [to, message] = under_way.begin()->second;
      under_way.erase(under_way.begin());
      team[to].receive(message);
    }
    const int robot = static_cast<int>(rng() % index(team.size()));
    if (const auto proposal = team[robot].improve(Deadline::nodes(calls))) {
      ++out.proposals;
      out.sent.push_back(*proposal);
      for (int to = 0; to < team.size(); ++to) {
        const int copies = to == robot || chance() < network.lost ? 0
                           : chance() < network.doubled           ? 2
                                                                  : 1;
        for (int copy = 0; copy < copies; ++copy) {
          const auto delay = static_cast<int>(rng() % index(network.delay_max + 1));
          under_way.emplace(step + 1 + delay, std::pair(to, *proposal));
        }
      }
    }
    bool searches = false;
    for (int each = 0; each < team.size(); ++each) {
      searches |= team[each].is_searching();
    }
    if (!searches && under_way.empty()) {
      out.is_finished = true;
      break;
    }
  }
  return out;
}

TeamProblem drawn(std::uint64_t seed) {
  return test::random_instance(seed, {5, 5, 1.0}, InformationMeasure::kMutual);
}

TEST(LocalSearchSession, ConvergesToOneLocalOptimumWithoutLoss) {
  double sum = 0.0;
  double sum_in_process = 0.0;
  int same = 0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    Team team({drawn(seed)});
    const Network late{0.0, 0.3, 20};
    const Outcome outcome = run(team, late, seed, 3, 1'000'000);
    ASSERT_TRUE(outcome.is_finished) << "seed " << seed;
    const TeamOracle& oracle = team.oracle_of(0);
    const Choice choice = team.choice_held_by(0);
    EXPECT_LE(largest_gain(oracle, choice), LocalSearchSession::kLeastRise_nats + kRounding)
        << "seed " << seed;
    for (int robot = 1; robot < team.size(); ++robot) {
      EXPECT_EQ(team.choice_held_by(robot), choice) << "seed " << seed;
    }
    const double value = value_of(oracle, choice);
    if (team[0].held()) {
      EXPECT_NEAR(team[0].held()->value_nats, value, 1e-8);
    }
    const TeamDecision in_process = distributed_local_search(oracle, {}, Deadline::never());
    sum += value;
    sum_in_process += in_process.value;
    same += in_process.choice == choice ? 1 : 0;
  }
  EXPECT_GE(sum, 0.99 * sum_in_process);
  EXPECT_GE(same, static_cast<int>(kInstances) * 8 / 10);
}

TEST(LocalSearchSession, EndsAndNeverLosesValueOnAnyNetwork) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    Team team({drawn(seed)});
    const Outcome outcome = run(team, {0.4, 0.4, 30}, seed, 3, 1'000'000);
    ASSERT_TRUE(outcome.is_finished) << "seed " << seed;
    for (int robot = 0; robot < team.size(); ++robot) {
      // Each session has a choice with the stated value. Other sessions may have better choices.
      const Choice choice = team.choice_held_by(robot);
      const double value = value_of(team.oracle_of(robot), choice);
      EXPECT_NEAR(team[robot].held() ? team[robot].held()->value_nats : 0.0, value, 1e-8);
      EXPECT_GE(value, 0.0);
      for (CandidateId id = team.oracle_of(robot).begin(robot);
           id < team.oracle_of(robot).end(robot); ++id) {
        EXPECT_LE(team.oracle_of(robot).individual_value(id),
                  value + LocalSearchSession::kLeastRise_nats)
            << "at least as good as the best single change";
      }
    }
  }
}

// Robots have different beliefs, so a change that raises J of one robot may lower J of another.
TEST(LocalSearchSession, EndsWhenBeliefsDiffer) {
  int disputed = 0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem drawn_problem = drawn(seed);
    std::vector<TeamProblem> problems(drawn_problem.candidates.size(), drawn_problem);
    std::mt19937_64 rng(seed);
    for (TeamProblem& problem : problems) {
      for (auto& candidates : problem.candidates) {
        for (Candidate& candidate : candidates) {
          candidate.energy_cost = std::uniform_real_distribution(0.0, 2.0)(rng);
        }
      }
    }
    Team team(problems);
    const Outcome outcome = run(team, {0.1, 0.1, 5}, seed, 3, 1'000'000);
    ASSERT_TRUE(outcome.is_finished) << "seed " << seed;
    for (const models::TeamProposal& proposal : outcome.sent) {
      const std::set<std::int64_t> solutions(proposal.history.begin(), proposal.history.end());
      EXPECT_EQ(solutions.size(), proposal.history.size()) << "a solution was repeated";
    }
    disputed += outcome.proposals > 3 * team.size() ? 1 : 0;
  }
  EXPECT_GE(disputed, 10);
}

TEST(LocalSearchSession, MakesTheSameProposalsAfterAnyInterruption) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const TeamProblem problem = drawn(seed);
    Team whole({problem});
    Team cut({problem});
    for (int robot = 0; robot < whole.size(); ++robot) {
      for (;;) {
        const auto proposal = whole[robot].improve(Deadline::never());
        std::optional<models::TeamProposal> again;
        while (!again && cut[robot].is_searching()) {
          again = cut[robot].improve(Deadline::nodes(1));
        }
        ASSERT_EQ(proposal.has_value(), again.has_value());
        if (!proposal) {
          break;
        }
        EXPECT_EQ(proposal->value_nats, again->value_nats);
        EXPECT_EQ(proposal->history, again->history);
      }
    }
  }
}

// A session that received only the newest message continues in the same way as the sender of that
// message.
TEST(LocalSearchSession, NeedsOnlyNewestMessage) {
  int checked = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Team team({drawn(seed)});
    const Outcome outcome = run(team, {}, seed, 3, 1'000'000);
    if (outcome.sent.empty()) {
      continue;
    }
    for (int robot = 0; robot < team.size(); ++robot) {
      const auto fresh = team.session_of(robot);
      EXPECT_TRUE(fresh->receive(outcome.sent.back()));
      EXPECT_FALSE(fresh->receive(outcome.sent.back())) << "a repeated message changes nothing";
      EXPECT_FALSE(fresh->improve(Deadline::never())) << "a local optimum for all robots";
      ++checked;
    }
  }
  EXPECT_GE(checked, 200);
}

// Coordinate descent: the teammates' choices are committed, and the robot adds its best candidate.
TEST(LocalSearchSession, AddsTheBestCandidateToCommittedChoices) {
  int added = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Team team({drawn(seed)});
    const TeamOracle& oracle = team.oracle_of(0);
    Choice choice(team.names().size(), kNoCandidate);
    std::vector<models::TeamChoice> committed;
    for (int robot = 1; robot < team.size(); ++robot) {
      if (oracle.begin(robot) < oracle.end(robot)) {
        choice[index(robot)] = oracle.begin(robot);
        committed.push_back(choice_of(oracle, oracle.begin(robot), team.names()));
      }
    }
    const double before = value_of(oracle, choice);
    CandidateId best = kNoCandidate;
    double best_value = before;
    for (CandidateId id = oracle.begin(0); id < oracle.end(0); ++id) {
      choice[0] = id;
      const double value = value_of(oracle, choice);
      if (value > best_value) {
        best_value = value;
        best = id;
      }
    }
    const auto proposal = team.session_of(0, committed)->improve(Deadline::never());
    if (best_value < before + LocalSearchSession::kLeastRise_nats) {
      continue;
    }
    ASSERT_TRUE(proposal) << "seed " << seed;
    ++added;
    EXPECT_EQ(proposal->choices.size(), committed.size() + 1);
    ASSERT_NE(proposal->find(team.names()[0]), nullptr);
    EXPECT_EQ(proposal->find(team.names()[0])->trajectory.start.x_m, best) << "seed " << seed;
    EXPECT_NEAR(proposal->value_nats, best_value - before, kRounding)
        << "the value counts only added choices";
  }
  EXPECT_GE(added, 80);
}

TEST(LocalSearchSession, StartsWithoutCommittedPlans) {
  const Team team({drawn(3)});
  for (const char* robot : {"Q1", "Q99"}) {
    models::TeamChoice choice;
    choice.robot = robot;
    EXPECT_THROW(team.session_of(0, std::vector{choice}), UsageError) << robot;
  }
}

TEST(LocalSearchSession, RefusesProposalsOfAnotherRoundTeamOrRobot) {
  Team team({drawn(3)});
  const auto sent = team[0].improve(Deadline::never());
  ASSERT_TRUE(sent);
  const auto is_refused = [&](int robot, auto&& spoil) {
    models::TeamProposal spoiled = *sent;
    spoil(spoiled);
    const auto session = team.session_of(robot);
    return !session->receive(spoiled) && !session->held();
  };
  EXPECT_FALSE(is_refused(1, [](auto&) {}));
  EXPECT_TRUE(is_refused(1, [](auto& p) { --p.round; }));
  EXPECT_TRUE(is_refused(1, [](auto& p) { p.stamp.time += Duration{1}; }));
  EXPECT_TRUE(is_refused(1, [](auto& p) { p.robot = "Q99"; }));
  EXPECT_TRUE(is_refused(1, [](auto& p) { p.choices[0].robot = "Q99"; }));
  EXPECT_TRUE(is_refused(1, [](auto& p) { p.history.back() ^= 1; }));
  EXPECT_TRUE(is_refused(1, [](auto& p) { p.history.clear(); }));
  EXPECT_TRUE(is_refused(1, [](auto& p) { p.choices[0].trajectory.start.x_m += 1e-9; }));
  EXPECT_TRUE(is_refused(1, [](auto& p) { p.value_nats = -p.value_nats; }));
  // A choice of the session's own robot with an unknown motion, as after a restart.
  EXPECT_TRUE(is_refused(0, [&](auto& p) {
    p.choices[0].trajectory.start.x_m += 100.0;
    p.history.back() = fingerprint(team.names(), p.choices);
  }));
}

TEST(LocalSearchSession, KeepsSeparationInProposals) {
  int kept = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const TeamProblem problem = drawn(seed);
    const TeamOracle oracle(problem);
    // Candidates are compatible only if their ids differ by an even number.
    const auto apart = [](const models::TeamChoice& a, const models::TeamChoice& b) {
      return static_cast<int>(a.trajectory.start.x_m - b.trajectory.start.x_m) % 2 == 0;
    };
    std::vector<std::string> robots;
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      robots.push_back("Q" + std::to_string(robot));
    }
    std::optional<models::TeamProposal> newest;
    for (int turn = 0; turn < 3 * oracle.robot_count(); ++turn) {
      const int robot = turn % oracle.robot_count();
      SessionSetup setup{robots, robot, kRound, kActivation, problem, {}, {}, apart};
      setup.problem.candidates.assign(robots.size(), {});
      setup.problem.candidates[index(robot)] = problem.candidates[index(robot)];
      for (CandidateId id = oracle.begin(robot); id < oracle.end(robot); ++id) {
        setup.own.push_back(choice_of(oracle, id, robots));
      }
      setup.candidate_of = [&oracle](const models::TeamChoice& choice) {
        return oracle.candidate(static_cast<CandidateId>(choice.trajectory.start.x_m));
      };
      LocalSearchSession session(std::move(setup));
      if (newest) {
        EXPECT_TRUE(session.receive(*newest));
      }
      while (const auto proposal = session.improve(Deadline::never())) {
        newest = proposal;
        for (const models::TeamChoice& a : proposal->choices) {
          for (const models::TeamChoice& b : proposal->choices) {
            EXPECT_TRUE(apart(a, b)) << "seed " << seed;
            kept += a.robot != b.robot ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_GE(kept, 100);
}

TEST(LocalSearchSession, AddsUnsharedInformationToTheValue) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const TeamProblem plain = drawn(seed);
    const TeamOracle before(plain);
    TeamProblem problem = plain;
    const Choice choice = test::random_choice(before, seed);
    double added = 0.0;
    std::mt19937_64 rng(seed);
    for (auto& candidates : problem.candidates) {
      for (Candidate& candidate : candidates) {
        candidate.unshared_nats = std::uniform_real_distribution(0.0, 3.0)(rng);
      }
    }
    const TeamOracle oracle(problem);
    for (const CandidateId id : choice) {
      added += id == kNoCandidate ? 0.0 : oracle.candidate(id).unshared_nats;
    }
    EXPECT_NEAR(value_of(oracle, choice), value_of(before, choice) + added, 1e-9);
  }
}

// The information that a proposal states for a motion may differ between proposals, for example
// after its robot restarted with another belief. The session uses the newest value.
TEST(LocalSearchSession, UsesTheNewestInformationOfAProposedMotion) {
  const auto session = [] {
    SessionSetup setup;
    setup.robots = {"Q1", "Q2"};
    setup.round = kRound;
    setup.activation = kActivation;
    setup.problem.candidates.resize(2);
    setup.candidate_of = [](const models::TeamChoice& choice) {
      Candidate effect;
      effect.energy_cost = choice.energy_nats;
      effect.unshared_nats = choice.information_nats;
      return effect;
    };
    return std::make_unique<LocalSearchSession>(std::move(setup));
  };
  const auto sent = [](double value_nats, double information_nats) {
    models::TeamProposal proposal;
    proposal.stamp.time = kActivation;
    proposal.robot = "Q2";
    proposal.round = kRound;
    proposal.value_nats = value_nats;
    proposal.choices = {{"Q2", {kActivation, {}, 1.0, {}}, information_nats, 1.0}};
    proposal.history = {fingerprint({"Q1", "Q2"}, proposal.choices)};
    return proposal;
  };
  const auto worthless = session();
  EXPECT_TRUE(worthless->receive(sent(1.0, 0.5)));
  EXPECT_TRUE(worthless->improve(Deadline::never())) << "the cost exceeds the information";
  const auto both = session();
  EXPECT_TRUE(both->receive(sent(1.0, 0.5)));
  EXPECT_TRUE(both->receive(sent(2.0, 3.0)));
  EXPECT_FALSE(both->improve(Deadline::never()))
      << "equal to a session that received only the second message";
}

}  // namespace
}  // namespace vantage::planner
