#include "tools/live/trial_display.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::tools {
namespace {

struct Lab {
  scenario::Scenario scenario =
      scenario::load_scenario(std::string(VANTAGE_SOURCE_DIR) + "/config/lab.yaml");
  logs::TrialMetrics metrics{scenario, from_utime(1'000'000)};
};

TEST(TrialDisplay, PrintsALineEveryFiveSeconds) {
  const Lab lab;
  TrialDisplay display(form_of(false, false));
  ASSERT_TRUE(display.is_due(from_utime(1'000'000)));
  testing::internal::CaptureStdout();
  display.show(from_utime(1'000'000), lab.scenario, lab.metrics, 0.0, {"a row"}, "LAB 7/7");
  const std::string shown = testing::internal::GetCapturedStdout();
  EXPECT_NE(shown.find("   LAB 7/7\n"), std::string::npos) << shown;
  EXPECT_EQ(shown.find("a row"), std::string::npos);
  EXPECT_FALSE(display.is_due(from_utime(5'999'999)));
  EXPECT_TRUE(display.is_due(from_utime(6'000'000)));
}

// The terminal may have been closed. An exception would then end `vantage up` and every driver in
// flight.
TEST(TrialDisplay, SurvivesClosedTerminal) {
  const int kept = dup(STDERR_FILENO);
  const int full = open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  dup2(full, STDERR_FILENO);
  TrialDisplay display(form_of(true, false));
  EXPECT_NO_THROW(display.show_event("landing"));
  dup2(kept, STDERR_FILENO);
  close(full);
  close(kept);
  testing::internal::CaptureStderr();
  display.show_event("landed");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "! landed\n");
}

TEST(TrialDisplay, ShowsRowsAndEventsBelowATable) {
  const Lab lab;
  TrialDisplay display(form_of(false, true));
  testing::internal::CaptureStdout();
  for (int i = 0; i < 8; ++i) {
    display.show_event("event " + std::to_string(i));
  }
  display.show(from_utime(1'000'000), lab.scenario, lab.metrics, 0.0, {"a row"}, "LAB 7/7");
  const std::string shown = testing::internal::GetCapturedStdout();
  EXPECT_LT(shown.find("a row"), shown.find("! event 2"));
  EXPECT_EQ(shown.find("event 1"), std::string::npos) << "only the last six events";
  EXPECT_NE(shown.find("event 7"), std::string::npos);
  EXPECT_EQ(shown.find("LAB 7/7"), std::string::npos);
  EXPECT_TRUE(display.is_due(from_utime(1'500'000)));
}

TEST(TrialDisplay, PrintsOnlyEventsWhenQuiet) {
  TrialDisplay display(form_of(true, false));
  EXPECT_FALSE(display.is_due(from_utime(1'000'000)));
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  display.show_event("a motor fell off");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "! a motor fell off\n");
}

}  // namespace
}  // namespace vantage::tools
