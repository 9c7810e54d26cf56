#include "planner/robot/external_answer.hpp"

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planner/robot/robot_planner.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

constexpr double kHair = 1e-6;  // relative excess; 1e-9 is tolerated

/// Checks answers to a planner with 4 steps of 0.5 s, for a vehicle with a different value for each
/// limit.
class MotionOfAnswer : public ::testing::Test {
 protected:
  MotionOfAnswer() {
    planner_.horizon_steps = 4;
    planner_.step_s = 0.5;
    limits_ = {2.0, 3.0, 1.0, 0.25};
    committed_.start_time = from_utime(1'700'000'000'000'000);
    committed_.start = {1.0, -2.0, 3.0};
    committed_.height_m = 1.5;
  }

  [[nodiscard]] std::optional<models::Trajectory> motion(const models::Trajectory& answer) const {
    models::RobotPlan plan;
    plan.trajectory = answer;
    return motion_of_answer(plan, committed_, planner_, limits_);
  }
  [[nodiscard]] models::Trajectory driven(const std::vector<models::PlanSegment>& segments) const {
    models::Trajectory answer = committed_;
    answer.segments = segments;
    return answer;
  }

  scenario::PlannerSpec planner_;
  models::VehicleLimits limits_;
  models::Trajectory committed_;
};

// The start may differ by 1 mm and 1 mrad in any direction. The motion then begins exactly at the
// committed start.
TEST_F(MotionOfAnswer, StartsAtTheCommittedPose) {
  using Change = std::function<void(models::Trajectory&, double)>;
  const std::vector<std::pair<std::string, Change>> changes = {
      {"x", [](auto& t, double by) { t.start.x_m += by; }},
      {"y", [](auto& t, double by) { t.start.y_m += by; }},
      {"both",
       [](auto& t, double by) {
         t.start.x_m += 0.6 * by;
         t.start.y_m -= 0.8 * by;
       }},
      {"yaw", [](auto& t, double by) { t.start.yaw_rad += by; }},
      {"yaw and a turn", [](auto& t, double by) { t.start.yaw_rad += by - 2.0 * kPi; }},
      {"height", [](auto& t, double by) { t.height_m += by; }},
  };
  for (const auto& [what, change] : changes) {
    for (const double side : {1.0, -1.0}) {
      models::Trajectory near = driven({{{1.0, 0.5}, 1.0, 0.0}});
      change(near, side * 0.999e-3);
      const auto motion = this->motion(near);
      ASSERT_TRUE(motion) << what << side;
      EXPECT_EQ(motion->start, committed_.start) << what;
      EXPECT_EQ(motion->height_m, committed_.height_m) << what;
      models::Trajectory far = driven({{{1.0, 0.5}, 1.0, 0.0}});
      change(far, side * 1.001e-3);
      EXPECT_FALSE(this->motion(far)) << what << side;
    }
  }
  for (const std::int64_t us : {1, -1}) {
    models::Trajectory other = driven({});
    other.start_time += Duration{us};
    EXPECT_FALSE(motion(other));
  }
}

// Each limit may be reached but not exceeded, in the first segment and in the last.
TEST_F(MotionOfAnswer, RespectsTheLimitsOfItsVehicle) {
  struct Edge {
    std::string what;
    models::PlanSegment last;
    models::PlanSegment beyond;
  };
  const double more = 1.0 + kHair;
  const std::vector<Edge> edges = {
      {"speed", {{2.0, 0.0}, 1.0, 0.0}, {{2.0 * more, 0.0}, 1.0, 0.0}},
      {"standing", {{0.0, 0.0}, 1.0, 0.0}, {{-kHair, 0.0}, 1.0, 0.0}},
      {"left", {{1.0, 3.0}, 1.0, 0.0}, {{1.0, 3.0 * more}, 1.0, 0.0}},
      {"right", {{1.0, -3.0}, 1.0, 0.0}, {{1.0, -3.0 * more}, 1.0, 0.0}},
      {"brake", {{1.0, 0.0}, 1.0, 1.0}, {{1.0, 0.0}, 0.9, 1.0 * more}},
      {"no negative brake", {{1.0, 0.0}, 1.0, 0.0}, {{1.0, 0.0}, 1.0, -kHair}},
      {"straight while it brakes", {{1.0, 0.0}, 1.0, 0.5}, {{1.0, kHair}, 1.0, 0.5}},
      {"never backwards", {{0.5, 0.0}, 1.0, 0.5}, {{0.5, 0.0}, 1.0 + 1e-5, 0.5}},
      {"a time", {{1.0, 0.0}, 1e-9, 0.0}, {{1.0, 0.0}, 0.0, 0.0}},
      {"no time back", {{1.0, 0.0}, 1.0, 0.0}, {{1.0, 0.0}, -1.0, 0.0}},
  };
  const models::PlanSegment slow{{0.5, 0.0}, 0.5, 0.0};
  for (const Edge& edge : edges) {
    EXPECT_TRUE(motion(driven({edge.last}))) << edge.what;
    EXPECT_TRUE(motion(driven({slow, edge.last}))) << edge.what;
    EXPECT_FALSE(motion(driven({edge.beyond}))) << edge.what;
    EXPECT_FALSE(motion(driven({slow, edge.beyond}))) << edge.what;
    EXPECT_FALSE(motion(driven({edge.beyond, slow}))) << edge.what;
  }
}

// Rounding of up to 1e-9 of each limit is tolerated, but no more.
TEST_F(MotionOfAnswer, ToleratesRoundingOfABillionth) {
  for (const double over : {0.5e-9, 2e-9}) {
    const double more = 1.0 + over;
    const std::vector<models::PlanSegment> segments = {
        {{2.0 * more, 0.0}, 1.0, 0.0},
        {{1.0, 3.0 * more}, 1.0, 0.0},
        {{1.0, 0.0}, 0.9, 1.0 * more},
        {{1.0, 0.0}, 2.0 * more, 0.0},
        {{2.0, 0.0}, 2.0 * more, 0.1},
        {{0.5, 0.0}, 1.0, 0.5 + over * 2.0},  // ends at −over · maximum speed
    };
    for (const models::PlanSegment& segment : segments) {
      const auto motion = this->motion(driven({segment}));
      EXPECT_EQ(motion.has_value(), over < 1e-9) << segment.control.speed_mps << ' ' << over;
    }
  }
}

// The driven segments may last as long as the horizon in total. The braking segments may last as
// long again.
TEST_F(MotionOfAnswer, LastsOneHorizonAndAStop) {
  const auto drive = [](double s) { return models::PlanSegment{{1.0, 0.0}, s, 0.0}; };
  const auto stop = [](double s) { return models::PlanSegment{{2.0, 0.0}, s, 0.1}; };
  EXPECT_TRUE(motion(driven({drive(2.0)})));
  EXPECT_FALSE(motion(driven({drive(2.0 + 1e-6)})));
  EXPECT_TRUE(motion(driven({drive(1.5), drive(0.5)})));
  EXPECT_FALSE(motion(driven({drive(1.5), drive(0.5 + 1e-6)})));
  EXPECT_TRUE(motion(driven({drive(2.0), stop(2.0)}))) << "each part has a separate limit";
  EXPECT_TRUE(motion(driven({stop(2.0)})));
  EXPECT_FALSE(motion(driven({stop(2.0 + 1e-6)})));
  EXPECT_FALSE(motion(driven({stop(1.5), stop(0.5 + 1e-6)})));
  EXPECT_TRUE(motion(driven(std::vector<models::PlanSegment>(16, drive(0.1)))));
  EXPECT_FALSE(motion(driven(std::vector<models::PlanSegment>(17, drive(0.1)))));
  // A vehicle accepts 64 segments, including the stop.
  planner_.horizon_steps = 40;
  EXPECT_TRUE(motion(driven(std::vector<models::PlanSegment>(63, drive(0.1)))));
  EXPECT_FALSE(motion(driven(std::vector<models::PlanSegment>(64, drive(0.1)))));
}

// A remaining speed is reduced to 0 with the vehicle's configured deceleration. A motion that
// already ends at speed 0 gets no stop.
TEST_F(MotionOfAnswer, EndsInAStop) {
  const auto stop_of = [&](const std::vector<models::PlanSegment>& segments) {
    const auto motion = this->motion(driven(segments));
    EXPECT_TRUE(motion);
    std::vector<models::PlanSegment> rest;
    if (motion) {
      EXPECT_EQ(motion->start_time, committed_.start_time);
      rest.assign(motion->segments.begin() + static_cast<std::ptrdiff_t>(segments.size()),
                  motion->segments.end());
    }
    return rest;
  };
  EXPECT_TRUE(stop_of({}).empty());
  EXPECT_TRUE(stop_of({{{2.0, 0.0}, 1.0, 0.0}, {{0.0, 1.0}, 1.0, 0.0}}).empty());
  EXPECT_TRUE(stop_of({{{0.5, 0.0}, 1.0, 0.5}}).empty());
  for (const auto& [segments, speed_mps] :
       {std::pair{std::vector<models::PlanSegment>{{{0.0, 1.0}, 1.0, 0.0}, {{1.5, 1.0}, 1.0, 0.0}},
                  1.5},
        std::pair{std::vector<models::PlanSegment>{{{2.0, 0.0}, 1.0, 0.5}}, 1.5}}) {
    const std::vector<models::PlanSegment> rest = stop_of(segments);
    ASSERT_EQ(rest.size(), 1U);
    EXPECT_NEAR(rest[0].control.speed_mps, speed_mps, 1e-12);
    EXPECT_EQ(rest[0].control.yaw_rate_radps, 0.0);
    EXPECT_EQ(rest[0].brake_mps2, limits_.brake_mps2);
    EXPECT_NEAR(rest[0].duration_s, speed_mps / limits_.brake_mps2, 1e-12);
  }
}

// An answer of this round is used, or refused and counted if it is invalid. An answer of another
// round is ignored.
TEST(ExternalPlanner, CountsInvalidAnswersOfItsRound) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.algorithm = "external";
  RobotPlanner planner(scenario, "Q2");
  PlanInputs inputs = test::first_inputs(scenario, 1, 3);
  const auto question = planner.external_request(inputs);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->robot, "Q2");
  EXPECT_EQ(question->source, models::PlanSource::kShifted);
  const auto source = [&](std::int64_t rounds_later, double speed_mps) {
    inputs.answer = *question;
    inputs.answer->round += rounds_later;
    inputs.answer->trajectory.segments = {{{speed_mps, 0.0}, 0.5, 0.0}};
    const auto plan = planner.plan(inputs, Deadline::nodes(0));
    EXPECT_TRUE(plan);
    return plan ? plan->source : models::PlanSource::kBraking;
  };
  EXPECT_EQ(source(0, 0.5), models::PlanSource::kSearched);
  EXPECT_EQ(planner.counts().answers_refused, 0);
  EXPECT_EQ(source(0, 99.0), models::PlanSource::kShifted);
  EXPECT_EQ(planner.counts().answers_refused, 1);
  EXPECT_EQ(source(1, 0.5), models::PlanSource::kShifted);
  EXPECT_EQ(source(-1, 99.0), models::PlanSource::kShifted);
  EXPECT_EQ(planner.counts().answers_refused, 1);
  inputs.answer.reset();
  EXPECT_EQ(planner.plan(inputs, Deadline::nodes(0))->source, models::PlanSource::kShifted);
  EXPECT_EQ(planner.counts().fallbacks_shifted, 4);
  EXPECT_EQ(planner.counts().checks_failed, 0);
}

}  // namespace
}  // namespace vantage::planner
