#include "tools/supervisor/supervisor.hpp"

#include <csignal>
#include <cstdio>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::tools {
namespace {

using std::chrono::milliseconds;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
const milliseconds kLong(30'000);  // never reached: every wait below is for something certain

TEST(Child, TellsHowItEnded) {
  Result<Child> good = Child::start({"true"});
  ASSERT_TRUE(good.ok());
  Child child = std::move(good).value();
  EXPECT_TRUE(child.wait(kLong)->is_success());
  EXPECT_TRUE(child.wait(kLong)->is_success());  // and goes on telling

  Child bad = std::move(Child::start({"sh", "-c", "exit 3"})).value();
  EXPECT_EQ(bad.wait(kLong)->describe(), "exit 3");
}

TEST(Child, IsEndedByASignal) {
  Child child = std::move(Child::start({"sleep", "1000"})).value();
  EXPECT_FALSE(child.wait(milliseconds(0)));
  child.send(SIGTERM);
  EXPECT_EQ(child.wait(kLong)->signal, SIGTERM);
}

TEST(Child, IsGoneWithItsOwner) {
  pid_t pid = 0;
  {
    const Child child = std::move(Child::start({"sleep", "1000"})).value();
    pid = child.pid();
    EXPECT_EQ(::kill(pid, 0), 0);
  }
  EXPECT_EQ(::kill(pid, 0), -1);  // reaped, not merely a zombie
}

TEST(Child, ThatCannotBeExecutedIsAnError) {
  const Result<Child> child = Child::start({"/nonexistent/program"});
  ASSERT_FALSE(child.ok());
  EXPECT_NE(child.error().message.find("No such file"), std::string::npos);
}

TEST(Supervisor, RefusesToStartWhatDoesNotExist) {
  Supervisor supervisor;
  EXPECT_THROW(supervisor.start({"ghost", {"/nonexistent/program"}}), StartupError);
}

TEST(Supervisor, StartsADeadProcessAgainAfterItsBackOffAndNotBefore) {
  Supervisor supervisor;
  supervisor.start({"brief", {"true"}});
  ASSERT_TRUE(supervisor.find("brief")->wait(kLong));
  EXPECT_EQ(supervisor.poll(0).size(), 1U);  // "ended"
  EXPECT_EQ(supervisor.status()[0].phase, ProcessPhase::kWaiting);
  EXPECT_TRUE(supervisor.poll(kSecond_ns / 5).empty());  // 0.25 s is the first back-off
  EXPECT_EQ(supervisor.restarts(), 0);
  EXPECT_EQ(supervisor.poll(kSecond_ns / 4).size(), 1U);  // "started again"
  EXPECT_EQ(supervisor.restarts(), 1);
  EXPECT_EQ(supervisor.status()[0].phase, ProcessPhase::kRunning);
}

TEST(Supervisor, GivesUpAfterTheStatedNumberOfRestarts) {
  Supervisor supervisor(RestartPolicy{.restarts_max = 2});
  supervisor.start({"brief", {"false"}});
  std::int64_t now_ns = 0;
  for (int death = 0; death < 3; ++death) {
    ASSERT_TRUE(supervisor.find("brief")->wait(kLong));
    supervisor.poll(now_ns);
    now_ns += 10 * kSecond_ns;
    supervisor.poll(now_ns);
  }
  EXPECT_TRUE(supervisor.any_given_up());
  EXPECT_EQ(supervisor.restarts(), 2);
  EXPECT_EQ(supervisor.status()[0].last_end, "exit 1");
  EXPECT_TRUE(supervisor.poll(now_ns + 100 * kSecond_ns).empty());
}

TEST(Supervisor, EndsEveryoneAndKillsThoseThatWillNot) {
  Supervisor supervisor;
  supervisor.start({"polite", {"sleep", "1000"}});
  // It says so once it ignores the signal: only then may we send it.
  const std::string ready = ::testing::TempDir() + "vantage_stubborn_ready";
  ::remove(ready.c_str());
  supervisor.start(
      {"stubborn", {"sh", "-c", "trap '' TERM; : > " + ready + "; while :; do sleep 1; done"}});
  while (::access(ready.c_str(), F_OK) != 0) {
    ASSERT_FALSE(supervisor.find("stubborn")->wait(milliseconds(5)));
  }
  const pid_t polite = supervisor.find("polite")->pid();
  const pid_t stubborn = supervisor.find("stubborn")->pid();
  EXPECT_EQ(supervisor.stop_all(milliseconds(300)), std::vector<std::string>{"stubborn"});
  EXPECT_EQ(::kill(polite, 0), -1);
  EXPECT_EQ(::kill(stubborn, 0), -1);
}

}  // namespace
}  // namespace vantage::tools
