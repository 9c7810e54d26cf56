#include "core/process.hpp"

#include <csignal>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage {
namespace {

int exit_code_of(const std::function<int()>& body, std::string* words = nullptr) {
  ::testing::internal::CaptureStderr();
  const int code = run_process("vantage-test", body);
  const std::string captured = ::testing::internal::GetCapturedStderr();
  if (words != nullptr) {
    *words = captured;
  }
  return code;
}

TEST(RunProcess, ReturnsTheExitCodeOfItsFunction) {
  EXPECT_EQ(exit_code_of([] { return 0; }), 0);
  EXPECT_EQ(exit_code_of([] { return 7; }), 7);
}

TEST(RunProcess, DistinguishesStartAndRunFailures) {
  std::string words;
  EXPECT_EQ(exit_code_of([]() -> int { throw StartupError("no such file: a.yaml"); }, &words), 2);
  EXPECT_EQ(words, "vantage-test: no such file: a.yaml\n");
  EXPECT_EQ(exit_code_of([]() -> int { throw UsageError("q must be ≥ 0"); }, &words), 2);
  EXPECT_NE(words.find("q must be ≥ 0"), std::string::npos);
  EXPECT_EQ(exit_code_of([]() -> int { throw std::runtime_error("link lost"); }, &words), 1);
  EXPECT_EQ(words, "vantage-test: link lost\n");
}

TEST(RunProcess, ReportsLackOfMemory) {
  std::string words;
  EXPECT_EQ(exit_code_of([]() -> int { throw std::bad_alloc(); }, &words), 1);
  EXPECT_EQ(words, "vantage-test: out of memory\n");
}

TEST(RunProcess, DetectsStopSignals) {
  EXPECT_FALSE(stop_requested());
  EXPECT_EQ(exit_code_of([] {
              std::raise(SIGTERM);
              return stop_requested() ? 0 : 3;
            }),
            0);
}

TEST(RunProcess, EndsWhenTerminalCloses) {
  EXPECT_EQ(exit_code_of([] {
              const int before = stop_requests();
              std::raise(SIGHUP);
              return stop_requests() - before;
            }),
            1);
}

TEST(RunProcess, IgnoresSighupIfItWasIgnoredAtStart) {
  std::signal(SIGHUP, SIG_IGN);  // as nohup does
  EXPECT_EQ(exit_code_of([] {
              const int before = stop_requests();
              std::raise(SIGHUP);
              return stop_requests() - before;
            }),
            0);
  std::signal(SIGHUP, SIG_DFL);
}

TEST(DefaultSignalScopeDeathTest, IsTerminatedByTheSignal) {
  const auto body = [] {
    const DefaultSignalScope reading;
    std::raise(SIGTERM);
    return 0;
  };
  EXPECT_EXIT(run_process("vantage-test", body), ::testing::KilledBySignal(SIGTERM), "");
}

TEST(DefaultSignalScopeDeathTest, IsTerminatedByAPendingSignal) {
  const auto body = [] {
    std::raise(SIGINT);
    const DefaultSignalScope reading;
    return 0;
  };
  EXPECT_EXIT(run_process("vantage-test", body), ::testing::KilledBySignal(SIGINT), "");
}

TEST(DefaultSignalScopeDeathTest, RestoresSignalHandlingAfterwards) {
  const auto body = [] {
    { const DefaultSignalScope reading; }
    std::raise(SIGTERM);
    return stop_requested() ? 5 : 0;
  };
  EXPECT_EXIT(std::exit(run_process("vantage-test", body)), ::testing::ExitedWithCode(5), "");
}

TEST(RunProcess, CountsStopRequests) {
  EXPECT_EQ(exit_code_of([] {
              const int before = stop_requests();
              std::raise(SIGINT);
              std::raise(SIGINT);
              return stop_requests() - before;
            }),
            2);
}

// When a terminal closes, both its shell and the kernel send SIGHUP.
TEST(RunProcess, CountsRepeatedSighupAsOneRequest) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(run_process("vantage-test",
                                    [] {
                                      std::raise(SIGHUP);
                                      std::raise(SIGHUP);
                                      return 10 + stop_requests();
                                    })),
              ::testing::ExitedWithCode(11), "");
}

TEST(RunProcess, IgnoresSighupInANewProcessIfItWasIgnoredAtStart) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_IGN);
        std::exit(run_process("vantage-test", [] {
          std::raise(SIGHUP);
          return 10 + stop_requests();
        }));
      },
      ::testing::ExitedWithCode(10), "");
}

TEST(RunProcess, SurvivesAWriteToAClosedPipe) {
  EXPECT_EQ(exit_code_of([] {
              std::raise(SIGPIPE);
              return 0;
            }),
            0);
}

}  // namespace
}  // namespace vantage
