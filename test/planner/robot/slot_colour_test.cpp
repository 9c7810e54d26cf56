#include "planner/robot/slot_colour.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "planner/robot/round.hpp"

namespace vantage::planner {
namespace {

/// Random robots in a square. Near robots are neighbours; each robot knows its neighbours' last
/// slots.
class Team {
 public:
  Team(int robots, double side_m, double near_m, int slots, unsigned seed)
      : near_m_(near_m), slots_(slots), rng_(seed), place_(0.0, side_m) {
    for (int i = 0; i < robots; ++i) {
      x_m_.push_back(place_(rng_));
      y_m_.push_back(place_(rng_));
      slot_.push_back(i % slots);
    }
    claimed_.assign(slot_.size(), false);
  }

  [[nodiscard]] std::vector<SlotHolder> neighbours(std::size_t of) const {
    std::vector<SlotHolder> near;
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (i != of && std::hypot(x_m_[i] - x_m_[of], y_m_[i] - y_m_[of]) <= near_m_) {
        near.push_back({static_cast<int>(i), slot_[i]});
      }
    }
    return near;
  }

  [[nodiscard]] std::size_t most_neighbours() const {
    std::size_t most = 0;
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      most = std::max(most, neighbours(i).size());
    }
    return most;
  }

  /// Runs one round; returns for each robot whether it searches. All robots of a slot decide by the
  /// plans that were published before the slot began.
  std::vector<bool> round() {
    std::vector<bool> searches(slot_.size(), false);
    const std::vector<int> before = slot_;
    for (int slot = 0; slot < slots_; ++slot) {
      for (std::size_t i = 0; i < slot_.size(); ++i) {
        if (planned_[i] == slot) {
          const SlotHolder own{static_cast<int>(i), slot};
          searches[i] = claimed_[i] && before[i] == slot && may_search(own, neighbours(i));
          next_[i] = next_slot(own, neighbours(i), slots_);
        }
      }
      for (std::size_t i = 0; i < slot_.size(); ++i) {  // publish the slots
        if (planned_[i] == slot) {
          slot_[i] = slot;
          claimed_[i] = true;
        }
      }
    }
    planned_ = next_;
    return searches;
  }
  void begin() {
    planned_ = slot_;
    next_ = slot_;
  }
  void stir(double by_m) {
    std::uniform_real_distribution<double> step(-by_m, by_m);
    for (std::size_t i = 0; i < x_m_.size(); ++i) {
      x_m_[i] += step(rng_);
      y_m_[i] += step(rng_);
    }
  }
  [[nodiscard]] bool are_near_at_once(const std::vector<bool>& searches) const {
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      for (const SlotHolder& each : neighbours(i)) {
        if (searches[i] && searches[static_cast<std::size_t>(each.robot)] &&
            each.slot == slot_[i]) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  double near_m_;
  int slots_;
  std::mt19937_64 rng_;
  std::uniform_real_distribution<double> place_;
  std::vector<double> x_m_;
  std::vector<double> y_m_;
  std::vector<int> slot_;     // slot of the newest plan
  std::vector<int> planned_;  // slot of this round
  std::vector<int> next_;
  std::vector<bool> claimed_;
};

TEST(SlotColour, DiffersBetweenNeighbours) {
  for (const int robots : {2, 65, 200, 1000}) {
    for (const int slots : {3, 16, 48}) {
      Team team(robots, 20.0 * std::sqrt(robots), 35.0, slots, 11);
      team.begin();
      for (int round = 0; round < 8; ++round) {
        const std::vector<bool> searches = team.round();
        EXPECT_FALSE(team.are_near_at_once(searches)) << robots << ", " << slots;
        EXPECT_EQ(std::find(searches.begin(), searches.end(), true) == searches.end(), round == 0)
            << "the first round only claims slots; then at least one robot searches";
      }
    }
  }
}

TEST(SlotColour, ConvergesSoThatAllRobotsSearch) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Team team(300, 350.0, 35.0, 40, seed);
    ASSERT_LT(team.most_neighbours(), 40U);
    team.begin();
    int rounds = 0;
    std::vector<bool> searches;
    do {
      searches = team.round();
      ++rounds;
    } while (rounds < 30 && std::find(searches.begin(), searches.end(), false) != searches.end());
    EXPECT_LE(rounds, 8) << "seed " << seed;
  }
}

TEST(SlotColour, LetsMostRobotsSearchDuringMotion) {
  Team team(300, 350.0, 35.0, 40, 5);
  team.begin();
  std::ptrdiff_t searched = 0;
  for (int round = 0; round < 60; ++round) {
    const std::vector<bool> searches = team.round();
    searched += round < 8 ? 0 : std::count(searches.begin(), searches.end(), true);
    team.stir(3.0);  // m; the distance of a round of 1 s at 3 m/s
  }
  EXPECT_GE(static_cast<double>(searched), 0.95 * 300 * 52);
}

TEST(SharedRound, HasConfiguredNumberOfSlots) {
  scenario::PlannerSpec spec;
  spec.execute_steps = 2;
  spec.slots = 48;
  for (const int robots : {49, 65, 200, 1000}) {
    const RoundSchedule schedule(spec, robots - 1, robots);
    ASSERT_TRUE(schedule.is_shared());
    ASSERT_EQ(schedule.slots(), 48);
    EXPECT_EQ(schedule.first_slot_index(), (robots - 1) % 48);
    for (int place = 0; place < 48; ++place) {
      const auto slot = schedule.slot(1'700'000'000, place);
      EXPECT_GE(slot.end - slot.begin, Duration{10'000}) << "0.5 s in 48";
      models::RobotPlan plan;
      plan.round = slot.round;
      plan.slot_start = slot.begin;
      EXPECT_EQ(schedule.slot_index_of(plan), place);
      plan.slot_start += Duration{1};
      EXPECT_EQ(schedule.slot_index_of(plan), std::nullopt);
    }
  }
  const RoundSchedule row(spec, 47, 48);
  EXPECT_FALSE(row.is_shared()) << "one slot per robot, as without `slots`";
  spec.slots = 0;
  EXPECT_EQ(row.slot(5).begin, RoundSchedule(spec, 47, 48).slot(5).begin);
}

TEST(SharedRound, HasOnePlanPerRobot) {
  scenario::PlannerSpec spec;
  spec.execute_steps = 2;
  spec.slots = 8;
  const RoundSchedule schedule(spec, 20, 100);
  std::mt19937_64 rng(3);
  auto slot = schedule.slot(1'700'000'000, 3);
  for (int i = 0; i < 1000; ++i) {
    const Time now = slot.begin + Duration{static_cast<std::int64_t>(rng() % 40'000)};
    const auto next = schedule.slot_after(slot.round, now, static_cast<int>(rng() % 8));
    EXPECT_EQ(next.round, slot.round + 1);
    EXPECT_GT(next.begin, now);
    slot = next;
  }
}

}  // namespace
}  // namespace vantage::planner
