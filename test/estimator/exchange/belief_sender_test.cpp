#include "estimator/exchange/belief_sender.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/index.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"

namespace vantage::estimator {
namespace {

constexpr Time kStart = from_utime(1'000'000'000'000'000);
constexpr std::size_t kPlenty = 100'000;
constexpr Duration kStep{500'000};

FilterSpec spec_of(int targets) {
  FilterSpec spec = test::open_spec({models::TargetKind::kRandomWalk, 2, 0.01},
                                    test::far_sighted(models::SensorKind::kPosition), targets);
  spec.communication_range_m = 100.0;
  return spec;
}

/// Returns a belief at step `step` with the given position variances, ids from 0.
models::RobotBelief belief_with(std::int64_t step, const std::vector<double>& variances) {
  models::RobotBelief belief;
  belief.stamp.time = kStart + step * kStep;
  belief.robot = "Q1";
  belief.step = step;
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const models::Gaussian gaussian{models::StateVector::Constant(2, 1.0),
                                    variances[i] * models::StateMatrix::Identity(2, 2)};
    belief.targets.push_back(
        {static_cast<int>(i), *models::to_information(gaussian), belief.stamp.time});
  }
  return belief;
}

std::vector<int> ids_of(const std::optional<models::CompactBelief>& message) {
  std::vector<int> ids;
  if (message) {
    for (const models::CompactTarget& target : message->targets) {
      ids.push_back(target.target_id);
    }
  }
  return ids;
}

TEST(BeliefSender, SendsOnlyWhatTeammatesLack) {
  BeliefSender sender(spec_of(3));
  EXPECT_EQ(ids_of(sender.select(belief_with(0, {1.0, 2.0, 3.0}), {}, kPlenty)),
            (std::vector<int>{0, 1, 2}));
  // The first message may have been lost, so everything is sent twice.
  EXPECT_EQ(ids_of(sender.select(belief_with(1, {1.0, 2.0, 3.0}), {}, kPlenty)),
            (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(ids_of(sender.select(belief_with(2, {1.0, 2.0, 3.0}), {}, kPlenty)),
            (std::vector<int>{}));
  EXPECT_EQ(ids_of(sender.select(belief_with(3, {1.0, 0.2, 3.0}), {}, kPlenty)),
            (std::vector<int>{1}));
}

TEST(BeliefSender, SendsTheLargestGainsFirst) {
  BeliefSender sender(spec_of(4));
  const auto message =
      sender.select(belief_with(0, {4.0, 0.01, 3.0, 0.02}), {}, BeliefSender::kPayloadMin);
  ASSERT_TRUE(message);
  ASSERT_GE(message->targets.size(), 2U);
  const std::vector<int> ids = ids_of(message);
  EXPECT_TRUE(std::find(ids.begin(), ids.end(), 1) != ids.end());
  EXPECT_TRUE(std::find(ids.begin(), ids.end(), 3) != ids.end());
}

TEST(BeliefSender, SendsNothingBelowTheMinimumPayload) {
  BeliefSender sender(spec_of(1));
  EXPECT_FALSE(sender.select(belief_with(0, {1.0}), {}, BeliefSender::kPayloadMin - 1));
}

TEST(BeliefSender, DoesNotRepeatWhatATeammateSent) {
  BeliefSender sender(spec_of(2));
  models::RobotBelief theirs = belief_with(0, {1.0, 100.0});
  theirs.robot = "Q2";
  sender.receive(theirs);
  const auto first = sender.select(belief_with(1, {1.05, 0.5}), {}, 300);
  const std::vector<int> ids = ids_of(first);
  EXPECT_TRUE(std::find(ids.begin(), ids.end(), 1) != ids.end());
}

TEST(BeliefSender, SendsEveryTargetAtLeastOncePerWholePeriod) {
  BeliefSender sender(spec_of(5));
  std::vector<Time> last(5, kStart);
  const auto steps = static_cast<int>(4 * BeliefSender::kWholePeriod / kStep);
  for (int step = 0; step < steps; ++step) {
    const auto belief = belief_with(step, {1.0, 1.0, 1.0, 1.0, 1.0});
    for (const int id : ids_of(sender.select(belief, {}, kPlenty))) {
      last[index(id)] = belief.stamp.time;
    }
    for (const Time& each : last) {
      ASSERT_LE(belief.stamp.time - each, BeliefSender::kWholePeriod);
    }
  }
}

TEST(BeliefSender, SendsEverythingAgainWhenATeammateReturns) {
  BeliefSender sender(spec_of(2));
  models::RobotBelief theirs = belief_with(0, {});
  theirs.robot = "Q2";
  sender.receive(theirs);
  for (int step = 0; step < 12; ++step) {
    sender.select(belief_with(step, {1.0, 1.0}), {}, kPlenty);
  }
  EXPECT_TRUE(ids_of(sender.select(belief_with(12, {1.0, 1.0}), {}, kPlenty)).empty());
  theirs.stamp.time = kStart + 13 * kStep;  // after more than kSilenceMax
  sender.receive(theirs);
  EXPECT_EQ(ids_of(sender.select(belief_with(14, {1.0, 1.0}), {}, kPlenty)),
            (std::vector<int>{0, 1}));
}

TEST(BeliefSender, IgnoresTargetsOfAnotherDimension) {
  BeliefSender sender(spec_of(2));
  models::RobotBelief theirs = belief_with(0, {1.0, 1.0});
  theirs.robot = "Q2";
  theirs.targets[0].information = {models::StateVector::Zero(4),
                                   models::StateMatrix::Identity(4, 4)};
  sender.receive(theirs);
  EXPECT_EQ(ids_of(sender.select(belief_with(1, {1.0, 0.5}), {}, kPlenty)),
            (std::vector<int>{0, 1}));
}

/// Returns a belief with a grid of 40 × 60 cells seen at the given instants.
models::RobotBelief with_cells(std::int64_t step, const std::vector<std::int64_t>& cells_utime) {
  models::RobotBelief belief = belief_with(step, {});
  belief.grid = {{0.0, 0.0}, 1.0, 40, 60};
  belief.last_seen_utime = cells_utime;
  return belief;
}

TEST(BeliefSender, SendsTheWholeGridInParts) {
  BeliefSender sender(spec_of(0));
  std::vector<std::int64_t> own(2400);
  for (std::size_t i = 0; i < own.size(); ++i) {
    own[i] = i % 7 == 0 ? 0 : to_utime(kStart) - static_cast<std::int64_t>(i % 11) * 500'000;
  }
  std::vector<std::int64_t> received(2400, 0);
  for (int step = 0; step < 2 * BeliefSender::kGridPeriodSteps; ++step) {
    const auto message = sender.select(with_cells(step, own), {}, 1000);
    const auto parts = message ? models::expand(*message) : std::nullopt;
    ASSERT_TRUE(!message || parts);
    if (parts && !parts->last_seen_utime.empty()) {
      for (std::size_t i = 0; i < own.size(); ++i) {
        ASSERT_LE(parts->last_seen_utime[i], own[i]);  // never later than the truth
        received[i] = std::max(received[i], parts->last_seen_utime[i]);
      }
    }
  }
  EXPECT_EQ(received, own);
}

// A row of 60 cells with different times needs 240 bytes.
TEST(BeliefSender, SendsGridRowsThatExceedTheLimit) {
  BeliefSender sender(spec_of(0));
  std::vector<std::int64_t> own(2400);
  for (std::size_t i = 0; i < own.size(); ++i) {
    own[i] = to_utime(kStart) - static_cast<std::int64_t>(i % 11) * 500'000;
  }
  std::size_t cells = 0;
  std::vector<bool> is_sent(2400, false);
  for (int step = 0; step < 2 * BeliefSender::kGridPeriodSteps; ++step) {
    const auto message = sender.select(with_cells(step, own), {}, BeliefSender::kPayloadMin);
    const auto parts = message ? models::expand(*message) : std::nullopt;
    for (std::size_t i = 0; parts && i < parts->last_seen_utime.size(); ++i) {
      if (parts->last_seen_utime[i] > 0 && !is_sent[i]) {
        is_sent[i] = true;
        ++cells;
      }
    }
  }
  EXPECT_GT(cells, 2000U);
}

TEST(BeliefSender, StaysWithinThePayloadLimit) {
  BeliefSender sender(spec_of(30));
  std::vector<std::int64_t> own(2400);
  for (int step = 0; step < 100; ++step) {
    for (std::size_t i = 0; i < own.size(); ++i) {
      own[i] =
          to_utime(kStart) +
          static_cast<std::int64_t>((i * 37 + 91 * static_cast<std::size_t>(step)) % 50) * 500'000;
    }
    models::RobotBelief belief = with_cells(step + 50, own);
    belief.targets = belief_with(step + 50, std::vector<double>(30, 1.0 / (1 + step))).targets;
    const std::size_t room = 300 + 10 * static_cast<std::size_t>(step);
    const auto message = sender.select(belief, {}, room);
    if (!message) {
      continue;
    }
    std::size_t bytes = 117 + message->robot.size() + message->runs.size();
    for (const models::CompactTarget& target : message->targets) {
      const auto n = static_cast<std::size_t>(target.dim);
      bytes += 10 + 6 * n + n * (n - 1);
    }
    EXPECT_LE(bytes, room);
  }
}

// Two robots are separated by a partition, and each knows only its own target. A fifth of the later
// messages is lost. At most kWholePeriod + 2 steps after its end, both know both targets.
TEST(BeliefSender, SharesAllTargetsAfterAPartition) {
  FilterSpec specs[] = {spec_of(2), spec_of(2)};
  specs[1].robot = "Q2";
  std::vector<DistributedFilter> filters;
  std::vector<BeliefSender> senders;
  for (int r = 0; r < 2; ++r) {
    filters.emplace_back(specs[r]);
    senders.emplace_back(specs[r]);
    models::RobotBelief prior = belief_with(0, {1.0, 1.0});
    prior.robot = specs[r].robot;
    prior.targets = {prior.targets[index(r)]};
    filters.back().rebase(prior);
  }
  std::vector<models::RobotBelief> arrived[2];
  constexpr int kHealed = 40;
  int together_at = 0;
  for (int step = 1; step < 100 && together_at == 0; ++step) {
    std::vector<models::RobotBelief> sent[2];
    for (int r = 0; r < 2; ++r) {
      StepInput input;
      input.time = kStart + step * kStep;
      std::vector<const models::RobotBelief*> beliefs;
      for (const auto& each : arrived[r]) {
        beliefs.push_back(&each);
        senders[index(r)].receive(each);
      }
      input.beliefs = beliefs;
      const models::RobotBelief own = filters[index(r)].step(input);
      const auto message = senders[index(r)].select(own, {}, 1000);
      const bool is_lost = step < kHealed || (step * 2 + r) % 5 == 0;
      if (message && !is_lost) {
        sent[1 - r].push_back(*models::expand(*message));
      }
    }
    for (int r = 0; r < 2; ++r) {
      arrived[r] = std::move(sent[r]);
    }
    const bool is_together = filters[0].track(1).known && filters[1].track(0).known;
    EXPECT_TRUE(!is_together || step > kHealed);
    together_at = is_together ? step : 0;
  }
  ASSERT_GT(together_at, 0);
  EXPECT_LE((together_at - kHealed) * kStep, BeliefSender::kWholePeriod + 2 * kStep);
}

}  // namespace
}  // namespace vantage::estimator
