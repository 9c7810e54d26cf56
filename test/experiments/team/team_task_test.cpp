#include "experiments/team/team_task.hpp"

#include <string>

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

struct Diary {
  std::string text;
  void plan() { text += " plan"; }
  void attack() { text += " attack"; }
  void move(int step_of_plan) { text += " move" + std::to_string(step_of_plan); }
  void observe() { text += " observe"; }
  void record() { text += " record"; }
};

TEST(RunTeamTask, ReplansPeriodicallyAndMayEndInsideAPlan) {
  Diary diary;
  run_team_task(diary, 5, 3);
  EXPECT_EQ(diary.text,
            " plan attack move0 observe record move1 observe record move2 observe record"
            " plan attack move0 observe record move1 observe record");
}

TEST(RunTeamTask, DoesNothingInZeroSteps) {
  Diary diary;
  run_team_task(diary, 0, 1);
  EXPECT_EQ(diary.text, "");
}

}  // namespace
}  // namespace vantage::experiments
