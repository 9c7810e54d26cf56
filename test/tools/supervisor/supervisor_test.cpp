#include "tools/supervisor/supervisor.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include "core/check.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::tools {
namespace {

using std::chrono::milliseconds;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
const milliseconds kLong(30'000);  // time limit that no wait below reaches

TEST(Child, ReportsHowItEnded) {
  Result<Child> good = Child::start({"true"});
  ASSERT_TRUE(good.ok());
  Child child = std::move(good).value();
  EXPECT_TRUE(child.wait(kLong)->is_success());
  EXPECT_TRUE(child.wait(kLong)->is_success());  // the result stays available

  Child bad = std::move(Child::start({"sh", "-c", "exit 3"})).value();
  EXPECT_EQ(bad.wait(kLong)->describe(), "exit 3");
}

TEST(Ask, ReturnsOutputAndExitStatus) {
  const Result<CommandOutput> answer = run_command({"sh", "-c", "echo one; echo two >&2; exit 3"});
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer.value().text, "one\ntwo\n");
  EXPECT_EQ(answer.value().exit.code, 3);
  EXPECT_EQ(run_command({"seq", "100000"}).value().text.size(), 588895U);  // overfills a pipe
  EXPECT_FALSE(run_command({"/nonexistent/program"}).ok());
}

TEST(Child, IsTerminatedByASignal) {
  Child child = std::move(Child::start({"sleep", "1000"})).value();
  EXPECT_FALSE(child.wait(milliseconds(0)));
  child.send(SIGTERM);
  EXPECT_EQ(child.wait(kLong)->signal, SIGTERM);
}

TEST(Child, IsKilledWithItsOwner) {
  pid_t pid = 0;
  {
    const Child child = std::move(Child::start({"sleep", "1000"})).value();
    pid = child.pid();
    EXPECT_EQ(::kill(pid, 0), 0);
  }
  EXPECT_EQ(::kill(pid, 0), -1);  // reaped, not just a zombie
}

TEST(Child, EndsWithItsDescendants) {
  std::array<int, 2> pipe_fds{};
  ASSERT_EQ(::pipe2(pipe_fds.data(), O_CLOEXEC), 0);
  ChildOptions options;
  options.output = pipe_fds[1];
  std::array<char, 16> text{};
  {
    const std::string starts = "(echo begun; exec sleep 1000) & wait";
    const Child child = std::move(Child::start({"sh", "-c", starts}, options)).value();
    ::close(pipe_fds[1]);
    ASSERT_EQ(::read(pipe_fds[0], text.data(), text.size()), 6);
  }
  pollfd ended{pipe_fds[0], POLLIN, 0};  // signalled when no process holds the write end
  ASSERT_EQ(::poll(&ended, 1, static_cast<int>(kLong.count())), 1) << "the process still runs";
  EXPECT_EQ(::read(pipe_fds[0], text.data(), text.size()), 0);
  ::close(pipe_fds[0]);
}

TEST(Child, InheritsTheEnvironmentWithChanges) {
  const std::string home = std::getenv("HOME") == nullptr ? "" : std::getenv("HOME");
  ChildOptions options;
  options.environment = {"HOME=/elsewhere", "VANTAGE_NEW=a=b"};
  const std::string condition =
      "[ \"$HOME\" = /elsewhere ] && [ \"$VANTAGE_NEW\" = a=b ] && [ -n \"$PATH\" ]";
  Child child = std::move(Child::start({"sh", "-c", condition}, options)).value();
  EXPECT_TRUE(child.wait(kLong)->is_success());
  EXPECT_EQ(home, std::getenv("HOME") == nullptr ? "" : std::getenv("HOME"))
      << "the environment of this process is unchanged";
  EXPECT_EQ(std::getenv("VANTAGE_NEW"), nullptr);
}

TEST(Child, ReportsAnUnexecutableProgram) {
  const Result<Child> child = Child::start({"/nonexistent/program"});
  ASSERT_FALSE(child.ok());
  EXPECT_NE(child.error().message.find("No such file"), std::string::npos);
}

TEST(Supervisor, RefusesAMissingProgram) {
  Supervisor supervisor;
  EXPECT_THROW(supervisor.start({"ghost", {"/nonexistent/program"}}, 0), StartupError);
}

using models::SupervisedPhase;
using Kind = SupervisorEvent::Kind;

TEST(Supervisor, RestartsAProcessAfterItsBackOff) {
  Supervisor supervisor;
  int preparations = 0;
  supervisor.start({"brief", {"true"}, false, [&] { ++preparations; }}, 0);
  ASSERT_TRUE(supervisor.find("brief")->wait(kLong));
  const auto ended = supervisor.poll(kSecond_ns);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].kind, Kind::kEnded);
  EXPECT_EQ(ended[0].text, "brief ended (exit 0); starting it again in 0.2 s");
  EXPECT_EQ(supervisor.status(kSecond_ns)[0].phase, SupervisedPhase::kWaiting);
  EXPECT_EQ(supervisor.status(kSecond_ns)[0].pid, 0);
  EXPECT_TRUE(supervisor.poll(kSecond_ns + kSecond_ns / 10).empty());
  EXPECT_EQ(supervisor.restarts(), 0);
  EXPECT_EQ(preparations, 0);
  const auto started = supervisor.poll(2 * kSecond_ns);
  ASSERT_EQ(started.size(), 1U);
  EXPECT_EQ(started[0].kind, Kind::kStarted);
  EXPECT_EQ(started[0].text, "brief started again (restart 1, 1.0 s down in total)");
  EXPECT_EQ(supervisor.restarts(), 1);
  EXPECT_EQ(preparations, 1);
  const SupervisedStatus status = supervisor.status(3 * kSecond_ns)[0];
  EXPECT_EQ(status.phase, SupervisedPhase::kRunning);
  EXPECT_EQ(status.down_s, 1.0);
  EXPECT_EQ(status.last_end, "exit 0");
  EXPECT_GT(status.pid, 0);
}

// PX4, for example, prints "exit 255" repeatedly and writes the reason only to its output file.
TEST(Supervisor, ReportsLastLineOfOutputFile) {
  const test::TemporaryFolder folder;
  Supervisor supervisor;
  ProcessSpec spec{"firmware",
                   {"sh", "-c", "echo first; printf 'already running\\t\\n \\n'; exit 3"}};
  spec.folder = folder.path() + "/Q1";
  supervisor.start(spec, 0);
  ASSERT_TRUE(supervisor.find("firmware")->wait(kLong));
  const auto ended = supervisor.poll(kSecond_ns);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(
      ended[0].text,
      "firmware ended (exit 3); starting it again in 0.2 s; last output: 'already running' (" +
          spec.folder + "/output.txt)");
}

TEST(Supervisor, AbandonsAProcessAfterTheMaximumRestarts) {
  Supervisor supervisor(RestartPolicy{.restarts_max = 2});
  supervisor.start({"brief", {"false"}, true}, 0);
  std::int64_t now_ns = 0;
  std::vector<SupervisorEvent> last;
  for (int death = 0; death < 3; ++death) {
    ASSERT_TRUE(supervisor.find("brief")->wait(kLong));
    last = supervisor.poll(now_ns);
    now_ns += 10 * kSecond_ns;
    supervisor.poll(now_ns);
  }
  ASSERT_EQ(last.size(), 1U);
  EXPECT_EQ(last[0].kind, Kind::kGivenUp);
  EXPECT_EQ(last[0].text,
            "brief ended (exit 1) and is given up: 2 restarts within 60 s did not help; the trial "
            "cannot continue without it");
  EXPECT_EQ(supervisor.lost_essential(), "brief");
  EXPECT_EQ(supervisor.restarts(), 2);
  EXPECT_EQ(supervisor.status(now_ns)[0].last_end, "exit 1");
  EXPECT_TRUE(supervisor.poll(now_ns + 100 * kSecond_ns).empty());
}

TEST(Supervisor, TreatsNoProcessAsEssentialByDefault) {
  Supervisor supervisor(RestartPolicy{.restarts_max = 0});
  supervisor.start({"brief", {"false"}}, 0);
  ASSERT_TRUE(supervisor.find("brief")->wait(kLong));
  supervisor.poll(0);
  EXPECT_EQ(supervisor.status(0)[0].phase, SupervisedPhase::kGivenUp);
  EXPECT_FALSE(supervisor.lost_essential());
}

TEST(Supervisor, RestartsNothingAfterStop) {
  Supervisor supervisor;
  supervisor.start({"brief", {"true"}}, 0);
  ASSERT_TRUE(supervisor.find("brief")->wait(kLong));
  supervisor.poll(0);
  EXPECT_TRUE(supervisor.stop_all(milliseconds(0)).empty());
  EXPECT_TRUE(supervisor.poll(100 * kSecond_ns).empty());
  EXPECT_EQ(supervisor.status(0)[0].phase, SupervisedPhase::kEnded);
}

/// Starts a process that ignores SIGTERM.
void start_stubborn(Supervisor& supervisor) {
  // The process creates the file when it ignores the signal; an earlier signal would end it.
  const std::string ready = ::testing::TempDir() + "vantage_stubborn_" + std::to_string(::getpid());
  ::remove(ready.c_str());
  supervisor.start(
      {"stubborn", {"sh", "-c", "trap '' TERM; : > " + ready + "; while :; do sleep 1; done"}}, 0);
  while (::access(ready.c_str(), F_OK) != 0) {
    ASSERT_FALSE(supervisor.find("stubborn")->wait(milliseconds(5)));
  }
}

TEST(Supervisor, KillsStubbornProcessesWhenHurried) {
  Supervisor supervisor;
  supervisor.start({"polite", {"sleep", "1000"}}, 0);
  start_stubborn(supervisor);
  const pid_t stubborn = supervisor.find("stubborn")->pid();
  // Returns true when the process "polite" has ended, long before the time limit of an hour.
  const auto hurry = [&] { return supervisor.find("polite")->wait(milliseconds(0)).has_value(); };
  EXPECT_EQ(supervisor.stop_all(std::chrono::hours(1), hurry),
            std::vector<std::string>{"stubborn"});
  EXPECT_EQ(::kill(stubborn, 0), -1);
  EXPECT_EQ(supervisor.status(0)[0].last_end, "signal 15");
  EXPECT_EQ(supervisor.status(0)[1].last_end, "killed");
}

TEST(Supervisor, StopsAllAndKillsUnresponsiveProcesses) {
  Supervisor supervisor;
  supervisor.start({"polite", {"sleep", "1000"}}, 0);
  start_stubborn(supervisor);
  const pid_t polite = supervisor.find("polite")->pid();
  const pid_t stubborn = supervisor.find("stubborn")->pid();
  EXPECT_EQ(supervisor.stop_all(milliseconds(300)), std::vector<std::string>{"stubborn"});
  EXPECT_EQ(::kill(polite, 0), -1);
  EXPECT_EQ(::kill(stubborn, 0), -1);
}

/// Returns a program that behaves like vantage's own: it reports on its pipe, unblocks stop signals
/// and runs `script` (Python). sign(b) writes the byte b, which states whether its vehicle flies.
ProcessSpec ours(const std::string& name, const std::string& script) {
  ProcessSpec spec{name,
                   {"python3", "-c",
                    "import os, signal, sys, time\n"
                    "life = int(os.environ['VANTAGE_LIFE_FD'])\n"
                    "def sign(byte): os.write(life, byte)\n"
                    "asked = []\n"
                    "stops = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}\n"
                    "for each in stops: signal.signal(each, lambda n, _: asked.append(n))\n"
                    "signal.pthread_sigmask(signal.SIG_UNBLOCK, stops)\n" +
                        script}};
  spec.patience_s = 1.0;
  return spec;
}

/// A supervisor that is polled until `holds` returns true; each poll advances its time and stores
/// the events.
struct Watched {
  explicit Watched(RestartPolicy policy = {}) : supervisor(policy) {}

  Supervisor supervisor;
  std::int64_t now_ns = kSecond_ns;
  std::vector<SupervisorEvent> events;
  bool until(const std::function<bool()>& holds, std::int64_t step_ns = kSecond_ns / 20) {
    for (int i = 0; i < 4'000; ++i) {
      now_ns += step_ns;
      for (SupervisorEvent& event : supervisor.poll(now_ns)) {
        events.push_back(std::move(event));
      }
      if (holds()) {
        return true;
      }
      ::poll(nullptr, 0, 5);
    }
    return false;
  }
  [[nodiscard]] int count(Kind kind) const {
    return static_cast<int>(std::count_if(events.begin(), events.end(),
                                          [&](const auto& each) { return each.kind == kind; }));
  }
  [[nodiscard]] SupervisedStatus status() const { return supervisor.status(now_ns)[0]; }
};

ProcessSpec driver(const std::string& script) {
  ProcessSpec spec = ours("quadrotor Q1", script);
  spec.vehicle = "Q1";
  return spec;
}

// Only heartbeats on the pipe count; messages on the network do not.
TEST(Supervisor, KillsAProcessWithoutHeartbeats) {
  Watched watched;
  watched.supervisor.start(ours("planner Q1", "sign(b'?')\ntime.sleep(1000)"), watched.now_ns);
  EXPECT_TRUE(watched.until([&] { return watched.count(Kind::kHung) == 1; }));
  EXPECT_EQ(watched.events[0].text, "planner Q1 sent no heartbeat: killing it");
  EXPECT_TRUE(watched.until([&] { return watched.count(Kind::kEnded) == 1; }, 0));
  EXPECT_EQ(watched.status().last_end, "signal 9");
}

TEST(Supervisor, DetectsAProcessStoppedBySignal) {
  Watched watched;
  watched.supervisor.start(ours("planner Q1", "while True:\n  sign(b'g')\n  time.sleep(0.005)"),
                           watched.now_ns);
  ASSERT_TRUE(watched.until([&] { return watched.status().in_flight == InFlight::kNo; }, 0));
  int looks = 0;
  EXPECT_TRUE(watched.until([&] { return ++looks > 200; }, kSecond_ns / 200));
  EXPECT_EQ(watched.count(Kind::kHung), 0);
  watched.supervisor.find("planner Q1")->send(SIGSTOP);
  EXPECT_TRUE(watched.until([&] { return watched.count(Kind::kHung) == 1; }));
}

TEST(Supervisor, DoesNotMonitorAProgramWithoutAPipe) {
  Watched watched;
  watched.supervisor.start({"firmware Q1", {"sleep", "1000"}}, watched.now_ns);
  int looks = 0;
  EXPECT_TRUE(watched.until([&] { return ++looks > 50; }, 60 * kSecond_ns));
  EXPECT_EQ(watched.count(Kind::kHung), 0);
}

TEST(Supervisor, NeverAbandonsADriverOfAFlyingVehicle) {
  for (const bool is_in_flight : {true, false}) {
    Watched watched(RestartPolicy{.backoff_first_s = 0.0, .restarts_max = 1});
    const std::string byte = is_in_flight ? "b'f'" : "b'g'";
    watched.supervisor.start(driver("sign(" + byte + ")"), watched.now_ns);
    const auto is_given_up = [&] { return watched.status().phase == SupervisedPhase::kGivenUp; };
    EXPECT_TRUE(watched.until([&] { return is_given_up() || watched.count(Kind::kStarted) >= 4; }));
    EXPECT_EQ(is_given_up(), !is_in_flight);
    EXPECT_EQ(watched.status().in_flight, is_in_flight ? InFlight::kYes : InFlight::kNo);
  }
}

TEST(Supervisor, WaitsForALandingDriverWithoutRestart) {
  Watched watched;
  watched.supervisor.start(driver("sign(b'f')\nwhile not asked: time.sleep(0.005)\nsign(b'g')"),
                           watched.now_ns);
  EXPECT_TRUE(watched.until([&] { return watched.status().in_flight == InFlight::kYes; }, 0));
  watched.supervisor.end_drivers();
  EXPECT_FALSE(watched.supervisor.have_drivers_ended());
  EXPECT_TRUE(watched.until([&] { return watched.supervisor.have_drivers_ended(); }, 0));
  EXPECT_EQ(watched.status().phase, SupervisedPhase::kEnded);
  EXPECT_EQ(watched.status().in_flight, InFlight::kNo);
  EXPECT_EQ(watched.status().last_end, "exit 0");
  int looks = 0;
  EXPECT_TRUE(watched.until([&] { return ++looks > 20; }, kSecond_ns));
  EXPECT_EQ(watched.count(Kind::kStarted), 0);
}

// The restarted driver, which reports on its own pipe, is asked to shut down immediately after its
// start.
TEST(Supervisor, RestartsDriverThatFailsInFlightDuringShutdown) {
  const test::TemporaryFolder folder;
  const std::string mark = folder.path() + "/failed";
  Watched watched;
  watched.supervisor.start(
      driver("if not os.path.exists('" + mark + "'):\n" + "  open('" + mark + "', 'w')\n" +
             "  sign(b'f')\n"
             "  while not asked: time.sleep(0.005)\n"
             "  os.kill(os.getpid(), signal.SIGKILL)\n"
             "while not asked: time.sleep(0.005)\nsign(b'g')"),
      watched.now_ns);
  EXPECT_TRUE(watched.until([&] { return watched.status().in_flight == InFlight::kYes; }, 0));
  watched.supervisor.end_drivers();
  EXPECT_TRUE(watched.until([&] { return watched.supervisor.have_drivers_ended(); }));
  EXPECT_EQ(watched.count(Kind::kStarted), 1);
  EXPECT_EQ(watched.status().in_flight, InFlight::kNo);
}

TEST(Supervisor, SendsDriversASecondSignal) {
  Watched watched;
  watched.supervisor.start(
      driver("sign(b'f')\nwhile len(set(asked)) < 2: time.sleep(0.005)\nsys.exit(1)"),
      watched.now_ns);
  EXPECT_TRUE(watched.until([&] { return watched.status().in_flight == InFlight::kYes; }, 0));
  watched.supervisor.end_drivers();
  watched.supervisor.end_drivers();
  EXPECT_TRUE(watched.until([&] { return watched.supervisor.have_drivers_ended(); }, 0));
  EXPECT_EQ(watched.status().in_flight, InFlight::kYes)
      << "the vehicle is left to its autopilot and reported";
  EXPECT_EQ(watched.count(Kind::kStarted), 0);
}

}  // namespace
}  // namespace vantage::tools
