#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/stream.hpp"
#include "logs/foxglove/values.hpp"
#include "test/logs/foxglove_json.hpp"
#include "test/logs/foxglove_notebook.hpp"

// Tests past data in a stream: tracks of bodies and observed ground cells.

namespace vantage::logs::foxglove {
namespace {

using Way = std::function<Eigen::Vector3d(double at_s)>;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

models::MocapFrame frame_of(Time time, const std::string& name, const Eigen::Vector3d& at_m) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  frame.bodies = {{name, {at_m, Quaternion::Identity()}, false}};
  return frame;
}

class Tracks : public ::testing::Test {
 protected:
  /// Sends mocap frames every 20 ms from the first time to the last, inclusive.
  void fly(const Way& way, double from_s, double to_s) {
    for (int k = static_cast<int>(std::lround(50.0 * from_s)); k <= std::lround(50.0 * to_s); ++k) {
      const double at_s = 0.02 * k;
      stream_.on(frame_of(kStart + from_seconds(at_s), "Q1", way(at_s)), kStart);
    }
  }
  std::vector<Eigen::Vector3d> newest() const {
    return points_of(notebook_.of("/tracks").back().at("entities").at(0).at("lines").at(0));
  }
  Notebook notebook_;
  Stream stream_{notebook_};
};

/// Returns the distance, m, of `point` from the nearest segment of the path.
double distance_m(const Eigen::Vector3d& point, const std::vector<Eigen::Vector3d>& way) {
  double least_m = (point - way.front()).norm();
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Eigen::Vector3d piece = way[i] - way[i - 1];
    const double along =
        std::clamp((point - way[i - 1]).dot(piece) / piece.squaredNorm(), 0.0, 1.0);
    least_m = std::min(least_m, (point - way[i - 1] - along * piece).norm());
  }
  return least_m;
}

TEST_F(Tracks, HaveAPointEveryTwoSecondsOnAStraightPath) {
  const Way straight = [](double at_s) { return Eigen::Vector3d(at_s, -0.5 * at_s, 1.5); };
  fly(straight, 0.0, 30.0);
  const auto track = newest();
  // The track covers the last 20 s in segments of 2 s and at most two shorter segments at its end.
  EXPECT_GE(track.size(), 11U);
  EXPECT_LE(track.size(), 13U);
  const double oldest_s = 30.0 - track.front().x();
  EXPECT_LE(oldest_s, 20.0 + 1e-9);
  EXPECT_GT(oldest_s, 20.0 - 2.0 - 0.2);
  EXPECT_NEAR(track.back().x(), 30.0, 0.5 + 0.2 + 1e-9)
      << "published every half second, with points every 0.2 s";
  for (std::size_t i = 1; i < track.size(); ++i) {
    EXPECT_LE(track[i].x() - track[i - 1].x(), 2.0 + 1e-9);
    EXPECT_EQ(track[i].z(), 1.5);
  }
}

// The paths are circles of 1 m radius in either direction, and a slow arc.
TEST_F(Tracks, DeviateByAtMostTwoCentimetres) {
  for (const double turn_radps : {0.8, -0.8, 0.05}) {
    Notebook notebook;
    Stream stream(notebook);
    std::vector<Eigen::Vector3d> gone;
    for (int k = 0; k <= 600; ++k) {
      const double at_s = 0.02 * k;
      gone.emplace_back(std::cos(turn_radps * at_s), std::sin(turn_radps * at_s), 1.0);
      stream.on(frame_of(kStart + from_seconds(at_s), "Q1", gone.back()), kStart);
    }
    const auto track =
        points_of(notebook.of("/tracks").back().at("entities").at(0).at("lines").at(0));
    EXPECT_LE(std::ssize(track), 1 + 12 * 5);
    for (const Eigen::Vector3d& point : track) {
      EXPECT_LT(distance_m(point, gone), 1e-9) << "the previous position";
    }
    for (std::size_t k = 0; k + 40 < gone.size(); ++k) {
      EXPECT_LT(distance_m(gone[k], track), 0.02) << turn_radps << " " << k;
    }
  }
}

TEST_F(Tracks, KeepCornersAndReversals) {
  // The path leads 2 m along x in 2 s, back to x = 1 m, then to the left.
  const Way there_and_back = [](double at_s) {
    return Eigen::Vector3d(at_s <= 2.0 ? at_s : std::max(1.0, 4.0 - at_s),
                           std::max(0.0, at_s - 3.0), 0.0);
  };
  fly(there_and_back, 0.0, 5.0);
  const auto track = newest();
  for (const Eigen::Vector3d& corner :
       {Eigen::Vector3d(2.0, 0.0, 0.0), Eigen::Vector3d(1.0, 0.0, 0.0)}) {
    EXPECT_LT(distance_m(corner, track), 0.01) << corner.transpose();
  }
}

// Tests time steps around 0.2 s and displacements around 2 cm.
TEST_F(Tracks, AddAPointAfterTwoCentimetresAndAFifthOfASecond) {
  const auto points = [&](double step_s, double step_m) {
    Notebook notebook;
    Stream stream(notebook);
    stream.on(frame_of(kStart, "Q1", {0.0, 0.0, 0.0}), kStart);
    stream.on(frame_of(kStart + from_seconds(step_s), "Q1", {0.0, step_m, 0.0}), kStart);
    stream.on(frame_of(kStart + from_seconds(0.6), "R1", {5.0, 0.0, 0.0}),
              kStart);  // triggers publication
    return points_of(notebook.of("/tracks").back().at("entities").at(0).at("lines").at(0)).size();
  };
  EXPECT_EQ(points(0.2, 0.021), 2U);
  EXPECT_EQ(points(0.199, 0.021), 1U);
  EXPECT_EQ(points(0.2, 0.019), 1U);
}

TEST_F(Tracks, OmitPointsWithinOneCentimetreOfALine) {
  const auto points = [&](const Eigen::Vector3d& middle_m, double last_s) {
    Notebook notebook;
    Stream stream(notebook);
    stream.on(frame_of(kStart, "Q1", {0.0, 0.0, 0.0}), kStart);
    stream.on(frame_of(kStart + from_seconds(0.5), "Q1", middle_m), kStart);
    stream.on(frame_of(kStart + from_seconds(last_s), "Q1", {1.0, 0.0, 0.0}), kStart);
    stream.on(frame_of(kStart + from_seconds(9.0), "R1", {5.0, 0.0, 0.0}), kStart);
    return points_of(notebook.of("/tracks").back().at("entities").at(0).at("lines").at(0)).size();
  };
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(points({0.5, side * 0.0099, 0.0}, 1.0), 2U);
    EXPECT_EQ(points({0.5, side * 0.0101, 0.0}, 1.0), 3U);
    EXPECT_EQ(points({0.5, 0.0, side * 0.0101}, 1.0), 3U);
  }
  EXPECT_EQ(points({0.5, 0.0, 0.0}, 2.0), 2U);
  EXPECT_EQ(points({0.5, 0.0, 0.0}, 2.000001), 3U) << "a segment lasts at most two seconds";
  EXPECT_EQ(points({1.5, 0.0, 0.0}, 1.0), 3U) << "the body left the line and returned";
  EXPECT_EQ(points({-0.5, 0.0, 0.0}, 1.0), 3U);
}

TEST_F(Tracks, ExpireAfterTwentySecondsOrANewRun) {
  const auto at = [&](double at_s, double x_m) {
    stream_.on(frame_of(kStart + from_seconds(at_s), "Q1", {x_m, x_m * x_m, 0.0}), kStart);
  };
  at(0.0, 0.0);
  at(10.0, 1.0);
  at(20.0, 2.0);
  EXPECT_EQ(newest().size(), 3U) << "exactly the maximum duration";
  at(20.6, 3.0);
  EXPECT_EQ(newest().size(), 3U) << "the first point has been dropped";
  EXPECT_EQ(newest().front().x(), 1.0);
  at(5.0, 4.0);
  EXPECT_EQ(newest(), (std::vector<Eigen::Vector3d>{{4.0, 16.0, 0.0}}));
}

TEST_F(Tracks, ArePublishedEveryHalfSecond) {
  const auto published_at = [&](double at_s) {
    const std::size_t before = notebook_.of("/tracks").size();
    stream_.on(frame_of(kStart + from_seconds(at_s), "Q1", {at_s, 0.0, 0.0}), kStart);
    return notebook_.of("/tracks").size() - before;
  };
  EXPECT_EQ(published_at(10.0), 1U);
  EXPECT_EQ(published_at(10.1), 0U);
  EXPECT_EQ(published_at(10.499999), 0U);
  EXPECT_EQ(published_at(10.5), 1U);
  EXPECT_EQ(published_at(10.5), 0U);
  EXPECT_EQ(published_at(10.499999), 1U) << "the clock was set back";
  EXPECT_EQ(published_at(10.9), 0U);
  EXPECT_EQ(published_at(3.0), 1U) << "another run";
}

TEST_F(Tracks, ShowVisibleBodiesInTeamColours) {
  stream_.on(lab_notice(), kStart);
  models::MocapFrame frame = frame_of(kStart, "Q2", {1.0, 2.0, 3.0});
  frame.bodies.push_back({"Q3", {{4.0, 5.0, 6.0}, Quaternion::Identity()}, true});
  frame.bodies.push_back({"R1", {{7.0, 8.0, 9.0}, Quaternion::Identity()}, false});
  stream_.on(frame, kStart);
  const Json entities = notebook_.of("/tracks").at(0).at("entities");
  ASSERT_EQ(entities.size(), 2U);
  EXPECT_EQ(entities[0].at("id"), "track/Q2");
  EXPECT_EQ(entities[0].at("timestamp"), to_json(kStart));
  EXPECT_EQ(rgb(entities[0].at("lines")[0].at("color")), robot_appearance(1).body_paint().middle());
  EXPECT_EQ(entities[1].at("id"), "track/R1");
  EXPECT_EQ(rgb(entities[1].at("lines")[0].at("color")), role("truth"));
}

TEST_F(Tracks, UseTruthOneSecondAfterTheLastMocap) {
  models::TruthFrame truth;
  truth.bodies.push_back({"Q1", -1, {}, Eigen::Vector3d::Zero()});
  const auto moves = [&](double at_s) {
    const std::size_t before = notebook_.of("/transforms").size();
    truth.stamp.time = kStart + from_seconds(at_s);
    truth.bodies[0].world_from_body.translation_m.x() = at_s;
    stream_.on(truth, kStart);
    return notebook_.of("/transforms").size() > before;
  };
  stream_.on(frame_of(kStart, "Q1", {0.0, 0.0, 0.0}), kStart);
  EXPECT_FALSE(moves(0.9));
  EXPECT_FALSE(moves(1.0));
  EXPECT_TRUE(moves(1.000001));
  EXPECT_EQ(newest().back().x(), 1.000001);
  stream_.on(frame_of(kStart + from_seconds(5.0), "Q1", {0.0, 0.0, 0.0}), kStart);
  EXPECT_FALSE(moves(5.5));
}

/// Returns the decoded ages or occupancies of the cells.
std::vector<float> values_of(const Json& grid) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : grid.at("data").get<std::string>()) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) {
      break;
    }
    group = group << 6U | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::uint8_t>(group >> static_cast<unsigned>(bits)));
    }
  }
  std::vector<float> values(bytes.size() / 4);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      word |= std::uint32_t{bytes[4 * i + k]} << (8 * k);
    }
    values[i] = std::bit_cast<float>(word);
  }
  return values;
}

models::RobotBelief seen_by(const std::string& robot, std::int64_t step,
                            const models::GridGeometry& grid, std::vector<double> seen_s) {
  models::RobotBelief belief;
  belief.robot = robot;
  belief.step = step;
  belief.stamp.time = kStart + from_seconds(10.0);
  belief.grid = grid;
  for (const double at_s : seen_s) {
    belief.last_seen_utime.push_back(at_s < 0.0 ? models::VisibilityGrid::kNeverSeen
                                                : to_utime(kStart + from_seconds(at_s)));
  }
  return belief;
}

TEST(Grids, ArePublishedPerRobotAndForTheTeam) {
  Notebook notebook;
  Stream stream(notebook);
  const models::GridGeometry grid{{0.0, 0.0}, 1.0, 2, 2};
  stream.on(seen_by("Q1", 5, grid, {1.0, 2.0, -1.0, -1.0}), kStart);
  stream.on(seen_by("Q2", 5, grid, {8.0, 1.0, -1.0, 4.0}), kStart);
  ASSERT_EQ(notebook.of("/grid").size(), 1U) << "once per step";
  EXPECT_EQ(values_of(notebook.of("/belief/Q2/grid").at(0)),
            (std::vector<float>{2.0F, 9.0F, -1.0F, 6.0F}));
  stream.on(seen_by("Q1", 6, grid, {1.0, 2.0, 3.0, -1.0}), kStart);
  ASSERT_EQ(notebook.of("/grid").size(), 2U);
  EXPECT_EQ(values_of(notebook.of("/grid").back()), (std::vector<float>{2.0F, 8.0F, 7.0F, 6.0F}));
  // A new grid geometry discards the old cells; data of another size is not shown.
  const models::GridGeometry other{{0.0, 0.0}, 1.0, 2, 1};
  stream.on(seen_by("Q1", 7, other, {3.0, -1.0}), kStart);
  EXPECT_EQ(values_of(notebook.of("/grid").back()), (std::vector<float>{7.0F, -1.0F}));
  stream.on(seen_by("Q1", 8, other, {3.0}), kStart);
  stream.on(seen_by("Q1", 8, {}, {}), kStart);
  EXPECT_EQ(notebook.of("/grid").size(), 3U);
  EXPECT_EQ(notebook.of("/belief/Q1/grid").size(), 3U);
}

TEST(Grids, MergeFromNeighbourhoodsIntoTheWorldGrid) {
  Notebook notebook;
  Stream stream(notebook);
  models::ScenarioNotice notice = lab_notice();
  const std::string none = "# neighbourhood_m: 40";
  const std::size_t at = notice.yaml.find(none);
  ASSERT_NE(at, std::string::npos);
  notice.yaml.replace(at, none.size(), none.substr(2));
  stream.on(notice, kStart);
  ASSERT_TRUE(notebook.of("/events").empty());
  const scenario::Scenario scenario = lab();
  const auto whole =
      models::GridGeometry::covering(scenario.world.bounds, scenario.estimator.grid_resolution_m);
  // Two neighbourhoods of one cell each, in opposite corners of the world grid.
  models::GridGeometry part = whole;
  part.columns = part.rows = 1;
  stream.on(seen_by("Q1", 5, part, {1.0}), kStart);
  part.origin_m += whole.resolution_m * Eigen::Vector2d(whole.columns - 1, whole.rows - 1);
  stream.on(seen_by("Q2", 6, part, {4.0}), kStart);
  const Json last = notebook.of("/grid").back();
  EXPECT_EQ(last.at("column_count"), whole.columns);
  std::vector<float> expected(static_cast<std::size_t>(whole.size()), -1.0F);
  expected.front() = 9.0F;
  expected.back() = 6.0F;
  EXPECT_EQ(values_of(last), expected);
}

TEST(Maps, ArePublishedPerRobotAndAsTheNewestOfTheTeam) {
  Notebook notebook;
  Stream stream(notebook);
  models::RobotMap map;
  map.robot = "Q1";
  map.stamp.time = kStart;
  map.grid = {{0.0, 0.0}, 1.0, 2, 1};
  map.own_looks = {0, 0};
  map.team_looks = {9, -9};
  map.entropy_nats = 7.5;
  stream.on(map, kStart);
  EXPECT_TRUE(notebook.of("/map").empty()) << "the detection probability is unknown";
  stream.on(lab_notice(), kStart);
  stream.on(map, kStart);
  map.robot = "Q2";
  map.team_looks = {-9, 9};
  stream.on(map, kStart);
  map.grid.rows = 0;
  map.team_looks.clear();
  stream.on(map, kStart);
  ASSERT_EQ(notebook.of("/map").size(), 2U);
  EXPECT_EQ(values_of(notebook.of("/map").back()), (std::vector<float>{0.0F, 1.0F}));
  EXPECT_EQ(values_of(notebook.of("/map/Q1").at(0)), (std::vector<float>{1.0F, 0.0F}));
  EXPECT_EQ(notebook.of("/map/Q2").size(), 1U);
}

}  // namespace
}  // namespace vantage::logs::foxglove
