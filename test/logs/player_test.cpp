#include "logs/play/player.hpp"

#include <chrono>
#include <deque>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

constexpr std::int64_t kMs = 1'000'000;         // ns
constexpr std::int64_t kBegin = 5'000'000'000;  // ns

/// A machine whose time passes only in sleep, and a log of one event each 100 ms.
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
      heard_.emplace_back((now_ns_ - kBegin) / kMs, event.channel, event.data[0]);
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

  /// (data, ms) of everything heard
  std::vector<std::pair<int, std::int64_t>> heard() const {
    std::vector<std::pair<int, std::int64_t>> out;
    for (const auto& [at_ms, channel, value] : heard_) {
      out.emplace_back(value, at_ms);
    }
    return out;
  }

  using Pairs = std::vector<std::pair<int, std::int64_t>>;
  test::TemporaryFolder folder_;
  std::optional<IndexedLog> log_;
  std::int64_t now_ns_ = kBegin;
  std::vector<std::tuple<std::int64_t, std::string, int>> heard_;
};

TEST_F(PlayerTest, PublishesEachEventAtItsInstant) {
  const PlayReport report = play({});
  ASSERT_EQ(heard_.size(), 20U);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(heard()[static_cast<std::size_t>(i)], (std::pair<int, std::int64_t>(i, 100 * i)));
  }
  EXPECT_EQ(report.published, 20);
  EXPECT_EQ(report.late_worst_us, 0.0);
  EXPECT_EQ(report.passes, 1);
}

TEST_F(PlayerTest, PlaysFasterAndOnlyAPart) {
  PlayOptions options;
  options.speed = 2.0;
  options.rules.from = from_utime(1'500'000);
  options.rules.to = from_utime(1'800'000);
  play(std::move(options));
  EXPECT_EQ(heard(), (Pairs{{5, 0}, {6, 50}, {7, 100}}));
}

TEST_F(PlayerTest, PausesWithoutLosingItsPlace) {
  PlayOptions options;
  options.rules.to = from_utime(1'400'000);
  play(std::move(options), {{140, "pause"}, {1'000, "resume"}});
  EXPECT_EQ(heard(), (Pairs{{0, 0}, {1, 100}, {2, 1'060}, {3, 1'160}}));
}

TEST_F(PlayerTest, SeeksForthAndBack) {
  PlayOptions options;
  play(std::move(options), {{110, "seek 1.75"}, {240, "step -1.5"}, {300, "quit"}});
  EXPECT_EQ(heard(), (Pairs{{0, 0}, {1, 100}, {18, 170}, {4, 270}}));
}

TEST_F(PlayerTest, ChangesItsSpeedWhereItIs) {
  PlayOptions options;
  options.rules.to = from_utime(1'400'000);
  play(std::move(options), {{160, "speed 0.5"}});
  EXPECT_EQ(heard(), (Pairs{{0, 0}, {1, 100}, {2, 240}, {3, 440}}));
}

TEST_F(PlayerTest, LoopsUntilItIsToldToStop) {
  PlayOptions options;
  options.loops = true;
  options.rules.to = from_utime(1'200'000);
  const PlayReport report = play(std::move(options), {{350, "quit"}});
  EXPECT_EQ(heard(), (Pairs{{0, 0}, {1, 100}, {0, 100}, {1, 200}, {0, 200}, {1, 300}, {0, 300}}));
  EXPECT_EQ(report.passes, 3);
}

TEST_F(PlayerTest, FiltersAndRenames) {
  PlayOptions options;
  options.rules.channels = ChannelFilter({"ODD"}, {});
  options.rules.names = ChannelRenames({"ODD=STRANGE"});
  options.rules.to = from_utime(1'200'000);
  play(std::move(options));
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(std::get<1>(heard_[0]), "STRANGE");
}

TEST_F(PlayerTest, StaysPausedUntilToldOtherwise) {
  PlayOptions options;
  options.starts_paused = true;
  options.rules.to = from_utime(1'200'000);
  play(std::move(options), {{500, " "}});
  EXPECT_EQ(heard(), (Pairs{{0, 500}, {1, 600}}));
}

TEST(ParsePlayCommand, KnowsItsWordsAndNoOthers) {
  using Kind = PlayCommand::Kind;
  EXPECT_EQ(parse_play_command("seek 12.5")->value, 12.5);
  EXPECT_EQ(parse_play_command("\x1b[D")->kind, Kind::kStep);
  EXPECT_EQ(parse_play_command("+")->kind, Kind::kFaster);
  for (const char* text : {"", "seek", "seek x", "seek 1e99", "seek -1e99", "speed 0", "speed -1",
                           "speed 1e3", "play", "seek 1 2", "speed nan"}) {
    EXPECT_FALSE(parse_play_command(text).has_value()) << text;
  }
}

// A clock that is set while it is logged: 1970, 2026, 1970 and 2026 again.
TEST_F(PlayerTest, WaitsOutNoBrokenTimeStamp) {
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
  EXPECT_EQ(heard(), (Pairs{{0, 0},
                            {1, pause_ms},
                            {2, pause_ms + 100},
                            {3, 2 * pause_ms + 100},
                            {4, 3 * pause_ms + 100},
                            {5, 3 * pause_ms + 200}}));
  EXPECT_EQ(report.gaps, 3);
  EXPECT_LT(report.late_worst_us, 1e3);

  heard_.clear();
  now_ns_ = kBegin;
  PlayOptions options;
  options.rules.to = from_utime(1'500'000);
  EXPECT_EQ(play(options).gaps, 0);
  EXPECT_EQ(heard(), (Pairs{{0, 0}})) << "what comes after the end is not waited for";
}

}  // namespace
}  // namespace vantage::logs
