#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "core/deadline.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/integration/network_support.hpp"

// LCM's own logger and player record and replay our messages.

namespace vantage {
namespace {

using test::Bytes;
using Messages = std::vector<std::pair<std::string, Bytes>>;

/// A running program. The destructor interrupts it and waits until it has ended.
class Program {
 public:
  explicit Program(std::vector<std::string> words) : pid_(fork()) {
    if (pid_ == 0) {
      std::vector<char*> arguments;
      for (std::string& word : words) {
        arguments.push_back(word.data());
      }
      arguments.push_back(nullptr);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
  }
  ~Program() { interrupt(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  Program(Program&&) = delete;
  Program& operator=(Program&&) = delete;

  void interrupt() {
    if (pid_ > 0) {
      kill(pid_, SIGINT);
      waitpid(pid_, nullptr, 0);
      pid_ = -1;
    }
  }

 private:
  pid_t pid_;
};

class LcmTools : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "vantage_log_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string log() const { return (folder_ / "flight.lcmlog").string(); }
  /// Returns the messages on `channel` in the log; the program may still be writing the log.
  [[nodiscard]] std::vector<Bytes> recorded(const std::string& channel) const {
    std::vector<Bytes> out;
    const std::unique_ptr<lcm_eventlog_t, decltype(&lcm_eventlog_destroy)> reader(
        lcm_eventlog_create(log().c_str(), "r"), &lcm_eventlog_destroy);
    for (lcm_eventlog_event_t* event = nullptr;
         reader && (event = lcm_eventlog_read_next_event(reader.get())) != nullptr;
         lcm_eventlog_free_event(event)) {
      if (event->channel == channel) {
        const auto* bytes = static_cast<const std::uint8_t*>(event->data);
        out.emplace_back(bytes, bytes + event->datalen);
      }
    }
    return out;
  }
  static Bytes payload(unsigned i) {
    return test::random_bytes(i % 20 == 0 ? 100'000 : 100 + i, i);
  }

  std::filesystem::path folder_;
};

TEST_F(LcmTools, LcmLoggerRecordsOurMessages) {
  constexpr unsigned kMessages = 100;
  constexpr unsigned kAtOnce = 20;  // less than the capacity of lcm-logger's queue, 31
  const auto ours = bus::open_transport(test::kUrl);
  {
    Program logger({"lcm-logger", "-q", "-f", "--lcm-url=" + test::kUrl, log()});
    const std::int64_t give_up_ns =
        monotonic_ns() + std::chrono::nanoseconds(test::kPatience).count();
    // The logger misses messages until it has started, and writes late. Sends until the messages
    // are in the log.
    const auto knock_until = [&](const std::function<bool()>& holds) {
      while (!holds() && monotonic_ns() < give_up_ns) {
        ours->publish("KNOCK", Bytes{1});
        ours->handle(std::chrono::milliseconds(10));
      }
    };
    knock_until([&] { return !recorded("KNOCK").empty(); });
    ASSERT_FALSE(recorded("KNOCK").empty());
    for (unsigned i = 0; i < kMessages; ++i) {
      ASSERT_TRUE(ours->publish("FLIGHT", payload(i)));
      if (const unsigned sent = i + 1; sent % kAtOnce == 0) {
        knock_until([&] { return recorded("FLIGHT").size() >= sent; });
      }
    }
  }
  const std::vector<Bytes> found = recorded("FLIGHT");
  ASSERT_EQ(found.size(), kMessages);
  for (unsigned i = 0; i < kMessages; ++i) {
    EXPECT_TRUE(found[i] == payload(i)) << i;
  }
}

TEST_F(LcmTools, LcmLogplayerReplaysToOurTransport) {
  constexpr unsigned kMessages = 100;
  {
    const auto writer = bus::open_transport("file://" + log() + "?mode=w");
    for (unsigned i = 0; i < kMessages; ++i) {
      ASSERT_TRUE(writer->publish("FLIGHT", payload(i)));
    }
  }
  const auto ours = bus::open_transport(test::kUrl);
  Messages received;
  test::collect(*ours, "FLIGHT", received);
  const Program player({"lcm-logplayer", "-l", test::kUrl, log()});
  test::handle_until(*ours, [&] { return received.size() >= kMessages; });
  ASSERT_EQ(received.size(), kMessages);
  for (unsigned i = 0; i < kMessages; ++i) {
    EXPECT_TRUE(received[i].second == payload(i)) << i;
  }
}

// LCM's logger and player do not change a byte of signed messages. A receiver that requires
// signatures refuses the replayed messages, whether or not it received the original ones.
TEST_F(LcmTools, KeepSignedMessagesUnchangedButReceiversRefuseTheirReplay) {
  constexpr unsigned kMessages = 25;  // a receiver queues 30 and drops the oldest of a larger burst
  const auto keys = test::keys_of_a_trial();
  bus::VirtualClock clock(from_utime(1'700'000'000'000'000));
  const auto ours = bus::open_transport(test::kUrl);
  bus::Bus sender(*ours, 1);
  sender.secure(test::authenticator(keys), clock);
  Messages sent;
  const auto ear = bus::open_transport(test::kUrl);
  test::collect(*ear, "VICON", sent);
  {
    Program logger({"lcm-logger", "-q", "-f", "--lcm-url=" + test::kUrl, log()});
    const std::int64_t give_up_ns =
        monotonic_ns() + std::chrono::nanoseconds(test::kPatience).count();
    // The log keeps the order of sending: when the log contains `name`, it contains all earlier
    // messages.
    const auto knock_until_log_has = [&](const std::string& name) {
      const auto has = [&] {
        std::ifstream in(log(), std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(in), {}};
        return text.find(name) != std::string::npos;
      };
      while (!has() && monotonic_ns() < give_up_ns) {
        ours->publish(name, Bytes(1000));
        ours->handle(std::chrono::milliseconds(10));
      }
    };
    knock_until_log_has("KNOCK");
    for (unsigned i = 0; i < kMessages; ++i) {
      clock.set(clock.now() + std::chrono::milliseconds(10));
      models::MocapFrame frame;
      frame.stamp.time = frame.arrival = clock.now();
      frame.frame_number = i;
      for (unsigned body = 0; body < i; ++body) {
        frame.bodies.push_back({"B" + std::to_string(body), Pose3{}, false});
      }
      sender.publish(bus::kVicon, frame);
      test::handle_until(*ear, [&] { return sent.size() > i; });
      ASSERT_EQ(sent.size(), i + 1);
    }
    knock_until_log_has("LAST");
  }
  const auto witness_link = bus::open_transport(test::kUrl);
  bus::Bus witness(*witness_link, 2);  // has the same keys and a clock one minute later
  bus::VirtualClock later(clock.now() + std::chrono::minutes(1));
  witness.secure(test::authenticator(keys), later);
  witness.use_clock(later);
  int believed = 0;
  witness.subscribe<models::MocapFrame>(bus::kVicon, [&](const auto&) { ++believed; });
  const auto reader_link = bus::open_transport(test::kUrl);
  bus::Bus reader(*reader_link, 3);  // has no key
  int read = 0;
  reader.subscribe<models::MocapFrame>(bus::kVicon, [&](const auto&) { ++read; });
  Messages played;
  test::collect(*ear, "VICON", played);
  const std::size_t before = sent.size();
  const Program player({"lcm-logplayer", "-l", test::kUrl, log()});
  test::handle_until(*ear, [&] { return played.size() >= kMessages; });
  test::handle_until(*reader_link, [&] { return read >= static_cast<int>(kMessages); });
  test::handle_until(*witness_link, [&] {
    return witness_link->stats().messages_received >= static_cast<std::int64_t>(kMessages);
  });
  ASSERT_EQ(played.size(), kMessages);
  for (unsigned i = 0; i < kMessages; ++i) {
    EXPECT_TRUE(played[i].second == sent[i].second) << i;
  }
  EXPECT_EQ(before, kMessages);
  EXPECT_EQ(read, static_cast<int>(kMessages));
  EXPECT_EQ(believed, 0);
  const auto counters = witness.counters();
  EXPECT_TRUE(std::any_of(counters.begin(), counters.end(), [](const models::NamedCount& counter) {
    return counter.name == "VICON.stale" && counter.count == static_cast<std::int64_t>(kMessages);
  }));
}

}  // namespace
}  // namespace vantage
