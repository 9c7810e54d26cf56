#include "logs/play/player.hpp"

#include <chrono>
#include <deque>
#include <limits>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

constexpr std::int64_t kMs = 1'000'000;         // ns
constexpr std::int64_t kBegin = 5'000'000'000;  // ns

/// A clock that advances only in sleep, and a log with one event per 100 ms.
class PlayerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Bytes bytes;
    for (std::int64_t i = 0; i < 20; ++i) {
      const Bytes data{static_cast<std::uint8_t>(i)};
      append_event({i, from_utime(1'000'000 + 100'000 * i), i % 2 == 0 ? "EVEN" : "ODD", data},
                   bytes);
    }
    test::write_file(folder_.file("a"), bytes);
    log_.emplace(folder_.file("a"));
  }

  PlayTimer timer() {
    return {[this] { return now_ns_; },
            [this](std::int64_t until_ns) { now_ns_ = std::max(now_ns_, until_ns); }};
  }

  struct Wish {
    std::int64_t at_ms;
    std::string text;
  };

  PlayReport play(PlayOptions options, std::deque<Wish> wishes = {}) {
    Player player(*log_, std::move(options), timer(), [this](const LogEvent& event) {
      played_.emplace_back((now_ns_ - kBegin) / kMs, event.channel, event.data[0]);
      return true;
    });
    return player.run(
        [&]() -> std::optional<PlayCommand> {
          if (wishes.empty() || (now_ns_ - kBegin) / kMs < wishes.front().at_ms) {
            return std::nullopt;
          }
          const auto command = parse_play_command(wishes.front().text);
          EXPECT_TRUE(command.has_value()) << wishes.front().text;
          wishes.pop_front();
          return command;
        },
        [] { return false; });
  }

  /// Returns (data, ms) of all published events.
  std::vector<std::pair<int, std::int64_t>> received() const {
    std::vector<std::pair<int, std::int64_t>> out;
    for (const auto& [at_ms, channel, value] : played_) {
      out.emplace_back(value, at_ms);
    }
    return out;
  }

  using Pairs = std::vector<std::pair<int, std::int64_t>>;
  test::TemporaryFolder folder_;
  std::optional<IndexedLog> log_;
  std::int64_t now_ns_ = kBegin;
  std::vector<std::tuple<std::int64_t, std::string, int>> played_;
};

TEST_F(PlayerTest, PublishesEachEventAtItsTime) {
  const PlayReport report = play({});
  ASSERT_EQ(played_.size(), 20U);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(received()[static_cast<std::size_t>(i)], (std::pair<int, std::int64_t>(i, 100 * i)));
  }
  EXPECT_EQ(report.published, 20);
  EXPECT_EQ(report.late_worst_us, 0.0);
  EXPECT_EQ(report.passes, 1);
}

TEST_F(PlayerTest, PlaysAPartOfTheLogAtTwiceTheSpeed) {
  PlayOptions options;
  options.speed = 2.0;
  options.rules.from = from_utime(1'500'000);
  options.rules.to = from_utime(1'800'000);
  play(std::move(options));
  EXPECT_EQ(received(), (Pairs{{5, 0}, {6, 50}, {7, 100}}));
}

TEST_F(PlayerTest, ContinuesAfterAPause) {
  PlayOptions options;
  options.rules.to = from_utime(1'400'000);
  play(std::move(options), {{140, "pause"}, {1'000, "resume"}});
  EXPECT_EQ(received(), (Pairs{{0, 0}, {1, 100}, {2, 1'060}, {3, 1'160}}));
}

TEST_F(PlayerTest, SeeksForwardsAndBackwards) {
  PlayOptions options;
  play(std::move(options), {{110, "seek 1.75"}, {240, "step -1.5"}, {300, "quit"}});
  EXPECT_EQ(received(), (Pairs{{0, 0}, {1, 100}, {18, 170}, {4, 270}}));
}

TEST_F(PlayerTest, ChangesItsSpeedWithoutAJump) {
  PlayOptions options;
  options.rules.to = from_utime(1'400'000);
  play(std::move(options), {{160, "speed 0.5"}});
  EXPECT_EQ(received(), (Pairs{{0, 0}, {1, 100}, {2, 240}, {3, 440}}));
}

TEST_F(PlayerTest, LoopsUntilStopped) {
  PlayOptions options;
  options.loops = true;
  options.rules.to = from_utime(1'200'000);
  const PlayReport report = play(std::move(options), {{350, "quit"}});
  EXPECT_EQ(received(),
            (Pairs{{0, 0}, {1, 100}, {0, 100}, {1, 200}, {0, 200}, {1, 300}, {0, 300}}));
  EXPECT_EQ(report.passes, 3);
}

TEST_F(PlayerTest, FiltersAndRenamesChannels) {
  PlayOptions options;
  options.rules.channels = ChannelFilter({"ODD"}, {});
  options.rules.names = ChannelRenames({"ODD=STRANGE"});
  options.rules.to = from_utime(1'200'000);
  play(std::move(options));
  ASSERT_EQ(played_.size(), 1U);
  EXPECT_EQ(std::get<1>(played_[0]), "STRANGE");
}

TEST_F(PlayerTest, StaysPausedUntilResumed) {
  PlayOptions options;
  options.starts_paused = true;
  options.rules.to = from_utime(1'200'000);
  play(std::move(options), {{500, " "}});
  EXPECT_EQ(received(), (Pairs{{0, 500}, {1, 600}}));
}

TEST(ParsePlayCommand, AcceptsOnlyItsCommands) {
  using Kind = PlayCommand::Kind;
  EXPECT_EQ(parse_play_command("seek 12.5")->value, 12.5);
  EXPECT_EQ(parse_play_command("\x1b[D")->kind, Kind::kStep);
  EXPECT_EQ(parse_play_command("+")->kind, Kind::kFaster);
  for (const char* text : {"", "seek", "seek x", "seek 1e99", "seek -1e99", "speed 0", "speed -1",
                           "speed 1e3", "play", "seek 1 2", "speed nan"}) {
    EXPECT_FALSE(parse_play_command(text).has_value()) << text;
  }
}

// The clock was set during the recording: the stamps are of 1970, 2026, 1970 and 2026 again.
TEST_F(PlayerTest, SkipsWaitsCausedByBrokenTimeStamps) {
  Bytes bytes;
  constexpr std::int64_t kNow = 1'795'000'000'000'000;
  std::int64_t number = 0;
  for (const std::int64_t utime : {std::int64_t{1'000'000}, kNow, kNow + 100'000,
                                   std::int64_t{2'000'000}, kNow + 200'000, kNow + 300'000}) {
    append_event({number, from_utime(utime), "A", Bytes{static_cast<std::uint8_t>(number)}}, bytes);
    ++number;
  }
  test::write_file(folder_.file("b"), bytes);
  log_.emplace(folder_.file("b"));
  const PlayReport report = play({});
  const auto pause_ms = Player::kAfterGap / std::chrono::milliseconds(1);
  EXPECT_EQ(received(), (Pairs{{0, 0},
                               {1, pause_ms},
                               {2, pause_ms + 100},
                               {3, 2 * pause_ms + 100},
                               {4, 3 * pause_ms + 100},
                               {5, 3 * pause_ms + 200}}));
  EXPECT_EQ(report.gaps, 3);
  EXPECT_LT(report.late_worst_us, 1e3);

  played_.clear();
  now_ns_ = kBegin;
  PlayOptions options;
  options.rules.to = from_utime(1'500'000);
  EXPECT_EQ(play(options).gaps, 0);
  EXPECT_EQ(received(), (Pairs{{0, 0}})) << "events after the end are not awaited";
}

TEST(ParsePlayCommand, MapsEachKeyAndWord) {
  using Kind = PlayCommand::Kind;
  const std::tuple<const char*, Kind, double> known[] = {
      {" ", Kind::kToggle, 0.0},
      {"q", Kind::kQuit, 0.0},
      {"quit", Kind::kQuit, 0.0},
      {"pause", Kind::kPause, 0.0},
      {"resume", Kind::kResume, 0.0},
      {"+", Kind::kFaster, 0.0},
      {"=", Kind::kFaster, 0.0},
      {"-", Kind::kSlower, 0.0},
      {"f", Kind::kStep, 5.0},
      {"b", Kind::kStep, -5.0},
      {"\x1b[C", Kind::kStep, 5.0},
      {"\x1b[D", Kind::kStep, -5.0},
      {"\x1b[A", Kind::kFaster, 0.0},
      {"\x1b[B", Kind::kSlower, 0.0},
      {"seek -2.5", Kind::kSeek, -2.5},
      {"step 3", Kind::kStep, 3.0},
      {"speed 2.5", Kind::kSpeed, 2.5},
      {"speed 64", Kind::kSpeed, 64.0},
      {"speed 0.015625", Kind::kSpeed, 1.0 / 64.0}};
  for (const auto& [text, kind, value] : known) {
    const auto command = parse_play_command(text);
    ASSERT_TRUE(command) << text;
    EXPECT_EQ(command->kind, kind) << text;
    EXPECT_EQ(command->value, value) << text;
  }
  for (const char* text : {"speed 64.001", "speed 0.0156", "step", "step ", "seek 1e12",
                           "step -1e12", "steps 3", "speed 2 ", "Q"}) {
    EXPECT_FALSE(parse_play_command(text)) << text;
  }
  EXPECT_TRUE(parse_play_command("seek 9.9e11"));
  EXPECT_TRUE(parse_play_command("seek -9.9e11"));
}

TEST_F(PlayerTest, DoublesAndHalvesItsSpeedBetweenItsLimits) {
  PlayOptions options;
  options.rules.to = from_utime(1'400'000);
  play(options, {{110, "+"}, {170, "-"}});
  // Keys are read every 20 ms: the speed is doubled from 120 ms on and normal again from 180 ms on.
  EXPECT_EQ(received(), (Pairs{{0, 0}, {1, 100}, {2, 160}, {3, 240}}));
  const auto last_speed = [&](double speed, const std::string& key) {
    double seen = 0.0;
    PlayOptions fast;
    fast.speed = speed;
    fast.starts_paused = true;
    std::deque<std::string> keys{key, "q"};
    Player player(*log_, fast, timer(), [](const LogEvent&) { return true; });
    player.run(
        [&]() -> std::optional<PlayCommand> {
          if (keys.empty()) {
            return std::nullopt;
          }
          const auto command = parse_play_command(keys.front());
          keys.pop_front();
          return command;
        },
        [] { return false; }, [&](const PlaySchedule& schedule, Time) { seen = schedule.speed(); });
    return seen;
  };
  EXPECT_EQ(last_speed(1.0, "+"), 2.0);
  EXPECT_EQ(last_speed(1.0, "-"), 0.5);
  EXPECT_EQ(last_speed(40.0, "+"), 64.0);
  EXPECT_EQ(last_speed(1.0 / 40.0, "-"), 1.0 / 64.0);
}

TEST_F(PlayerTest, TogglesAndPausesRepeatedly) {
  PlayOptions options;
  options.rules.to = from_utime(1'400'000);
  play(options, {{120, " "},
                 {300, "pause"},
                 {420, " "},
                 {500, "resume"},
                 {520, " "},
                 {700, "resume"},
                 {740, "resume"}});
  // Playback was paused at 120 ms for 300 ms, and at 220 ms for 180 ms.
  EXPECT_EQ(received(), (Pairs{{0, 0}, {1, 100}, {2, 500}, {3, 780}}));
}

TEST_F(PlayerTest, ClampsSeeksToTheLog) {
  PlayOptions options;
  options.rules.from = from_utime(1'500'000);
  options.rules.to = from_utime(1'800'000);
  play(options, {{110, "seek -100"}, {150, "quit"}});
  EXPECT_EQ(received(), (Pairs{{5, 0}, {6, 100}, {5, 120}})) << "not before the beginning";
  played_.clear();
  now_ns_ = kBegin;
  const PlayReport report = play(options, {{110, "step 1000"}});
  EXPECT_EQ(received(), (Pairs{{5, 0}, {6, 100}}));
  EXPECT_EQ(report.passes, 1) << "the end is reached";
  played_.clear();
  now_ns_ = kBegin;
  options.rules.to = from_utime(1'400'000);  // before the log begins
  EXPECT_EQ(play(options, {{0, "seek 0.1"}}).published, 0);
}

TEST_F(PlayerTest, PlaysTheWholeLogByDefault) {
  PlayOptions options;
  options.rules.from = from_utime(1);
  options.rules.to = from_utime(900'000'000);
  EXPECT_EQ(play(options).published, 20);
  EXPECT_EQ(received().front(), (std::pair<int, std::int64_t>(0, 0))) << "without a wait";
  EXPECT_EQ(received().back(), (std::pair<int, std::int64_t>(19, 1900)));
  const PlayOptions usual;
  EXPECT_EQ(usual.speed, 1.0);
  EXPECT_FALSE(usual.loops);
  EXPECT_FALSE(usual.starts_paused);
  EXPECT_EQ(usual.gap_max, std::chrono::seconds(60));
}

// Time spent by the sink counts as lateness: 3 ms for every other event, and 250 ms once.
TEST_F(PlayerTest, ReportsItsLateness) {
  Player player(*log_, {}, timer(), [&](const LogEvent& event) {
    now_ns_ += (event.data[0] == 5 ? 250 : event.data[0] % 2 == 0 ? 3 : 0) * kMs;
    return event.data[0] != 19;
  });
  const PlayReport report = player.run([] { return std::nullopt; }, [] { return false; });
  EXPECT_EQ(report.published, 19);
  EXPECT_EQ(report.failed, 1);
  EXPECT_NEAR(report.late_worst_us, 250e3, 1e-6);
  // The events 100 ms and 200 ms after the slow one were late as well.
  EXPECT_NEAR(report.late_mean_us, (9 * 3e3 + 250e3 + 153e3 + 53e3) / 19.0, 1e-6);
  EXPECT_EQ(report.late_over_1_ms, 9 + 3);
}

// Events with names that LCM does not allow are counted and not played.
TEST_F(PlayerTest, CountsUnpublishableEvents) {
  PlayOptions options;
  options.rules.names = ChannelRenames({"ODD=" + std::string(64, 'A')});
  const PlayReport report = play(options);
  EXPECT_EQ(report.published, 10);
  EXPECT_EQ(report.failed, 10);
  EXPECT_EQ(played_.size(), 10U);
}

TEST_F(PlayerTest, ReportsItsPositionEvery20Milliseconds) {
  std::vector<std::int64_t> asked_ms;
  std::vector<std::int64_t> told_ms;
  PlayOptions options;
  options.speed = 0.5;
  options.rules.to = from_utime(1'200'000);
  Player player(*log_, options, timer(), [](const LogEvent&) { return true; });
  player.run([] { return std::nullopt; },
             [&] {
               asked_ms.push_back((now_ns_ - kBegin) / kMs);
               return false;
             },
             [&](const PlaySchedule& schedule, Time here) {
               EXPECT_FALSE(schedule.is_paused());
               told_ms.push_back((here - from_utime(1'000'000)) / std::chrono::milliseconds(1));
             });
  ASSERT_GE(asked_ms.size(), 10U);
  for (std::size_t i = 0; i < asked_ms.size(); ++i) {
    EXPECT_EQ(asked_ms[i], 20 * static_cast<std::int64_t>(i));
    EXPECT_EQ(told_ms[i], 10 * static_cast<std::int64_t>(i)) << "at half speed";
  }
}

TEST_F(PlayerTest, StopsOnRequest) {
  int checks = 0;
  PlayOptions options;
  options.loops = true;
  Player player(*log_, options, timer(), [](const LogEvent&) { return true; });
  const PlayReport report = player.run([] { return std::nullopt; }, [&] { return ++checks > 100; });
  EXPECT_EQ(report.passes, 1);
  EXPECT_EQ(report.published, 20 + 1) << "1900 ms, then from the beginning until 2000 ms";
}

TEST_F(PlayerTest, SkipsGapsLongerThanOneMinute) {
  for (const std::int64_t gap_us : {60'000'000, 60'000'001}) {
    Bytes bytes;
    append_event({0, from_utime(1'000'000), "A", Bytes{0}}, bytes);
    append_event({1, from_utime(1'000'000 + gap_us), "A", Bytes{1}}, bytes);
    const std::string path = folder_.file("gap" + std::to_string(gap_us));
    test::write_file(path, bytes);
    log_.emplace(path);
    played_.clear();
    now_ns_ = kBegin;
    EXPECT_EQ(play({}).gaps, gap_us > 60'000'000 ? 1 : 0);
    EXPECT_EQ(received().back().second, gap_us > 60'000'000 ? 500 : 60'000);
  }
}

// One of 100 stamps is invalid, for example near the largest possible time.
TEST_F(PlayerTest, PlaysEveryEventDespiteOneBadStamp) {
  constexpr std::int64_t kNow = 1'795'000'000'000'000;
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t broken :
       {std::int64_t{0}, kMost / 1000, kMost - 100'000'000, kMost - 30'000'000, kMost - 1, kMost}) {
    Bytes bytes;
    for (std::int64_t i = 0; i < 100; ++i) {
      const std::int64_t utime = i == 50 ? broken : kNow + 1'000 * i;
      append_event({i, from_utime(utime), "A", Bytes{static_cast<std::uint8_t>(i)}}, bytes);
    }
    test::write_file(folder_.file("b"), bytes);
    log_.emplace(folder_.file("b"));
    played_.clear();
    now_ns_ = kBegin;
    EXPECT_EQ(play({}).published, 100) << broken;
    EXPECT_EQ(play({}, {{0, "seek 0.05"}, {5'000, "quit"}}).failed, 0) << broken;
    EXPECT_LT((now_ns_ - kBegin) / kMs, 60'000) << broken;
  }
}

}  // namespace
}  // namespace vantage::logs
