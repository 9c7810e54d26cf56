#include "estimator/filter/step_record.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "test/estimator/filter_support.hpp"
#include "test/support/allocation_counter.hpp"

// Tests of the records of a step's inputs and of the table of tracks by target.

namespace vantage::estimator {
namespace {

using test::instant;

KnownTrack known_track(int target_id, double x_m) {
  KnownTrack known;
  known.target_id = target_id;
  known.track.known = true;
  known.track.information =
      models::to_information({Eigen::Vector2d(x_m, 0.0), Eigen::Matrix2d::Identity()}).value();
  return known;
}

std::vector<int> ids_of(const TrackTable& tracks) {
  std::vector<int> ids;
  for (const KnownTrack& each : tracks) {
    ids.push_back(each.target_id);
  }
  return ids;
}

TEST(TrackTable, HasEachTargetOnceOrderedById) {
  TrackTable tracks(8);
  for (const int id : {5, 2, 7, 0, 3}) {
    EXPECT_EQ(tracks.put(known_track(id, id)).target_id, id);
  }
  EXPECT_EQ(ids_of(tracks), (std::vector{0, 2, 3, 5, 7}));
  const TrackTable& same = tracks;
  for (const int id : {0, 2, 3, 5, 7}) {
    ASSERT_NE(tracks.find(id), nullptr);
    EXPECT_EQ(tracks.find(id)->target_id, id);
    EXPECT_EQ(same.find(id), tracks.find(id));
  }
  for (const int id : {-1, 1, 4, 6, 8}) {
    EXPECT_EQ(tracks.find(id), nullptr);
    EXPECT_EQ(same.find(id), nullptr);
  }
  // A new entry for a known target replaces the old one.
  for (const int id : {0, 3, 7}) {
    EXPECT_EQ(tracks.put(known_track(id, 10.0 + id)).track.information.vector(0), 10.0 + id);
  }
  EXPECT_EQ(ids_of(tracks), (std::vector{0, 2, 3, 5, 7}));
  EXPECT_EQ(tracks.find(3)->track.information.vector(0), 13.0);
  EXPECT_EQ(tracks.find(5)->track.information.vector(0), 5.0);
  tracks.erase_if([](const KnownTrack& each) { return each.target_id % 2 == 1; });
  EXPECT_EQ(ids_of(tracks), (std::vector{0, 2}));
  tracks.clear();
  EXPECT_TRUE(ids_of(tracks).empty());
}

TEST(TrackTable, HasTheStatedCapacity) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  TargetTable<ReceivedTrack> few(3);
  const vantage::test::AllocationCounter of_few;
  for (int id = 3; id-- > 0;) {
    few.put({id, {}, 1.0});
  }
  EXPECT_EQ(of_few.count(), 0U);
  // A table with a huge or a negative capacity is usable.
  TargetTable<ReceivedTrack> many(2'000'000'000);
  const vantage::test::AllocationCounter of_many;
  constexpr int kRoom = static_cast<int>(TargetTable<ReceivedTrack>::kReserved);
  for (int id = kRoom; id-- > 0;) {
    many.put({id, {}, 1.0});
  }
  EXPECT_EQ(of_many.count(), 0U);
  TargetTable<ReceivedTrack> none(-1);
  none.put({4, {}, 1.0});
  EXPECT_NE(none.find(4), nullptr);
}

std::vector<std::pair<Time, int>> looks_of(const StepRecord& record) {
  std::vector<std::pair<Time, int>> looks;
  for (int i = 0; i < record.observation_count; ++i) {
    const Observation& look = record.observations[static_cast<std::size_t>(i)];
    looks.emplace_back(look.time, look.source);
  }
  return looks;
}

// Observations are sorted for any order of arrival, also beyond the capacity.
TEST(StepRecord, OrdersMeasurementsByTimeAndRobot) {
  std::vector<std::pair<Time, int>> sorted;
  for (int step = 0; step < 2; ++step) {
    for (int source = -1; source < 2; ++source) {
      sorted.emplace_back(instant(step), source);
    }
  }
  std::vector<std::pair<Time, int>> order = sorted;
  StepRecord record(3, 4);
  do {
    record.start(instant(0), instant(1), TrackTable(3));
    EXPECT_EQ(record.observation_count, 0);
    for (const auto& [time, source] : order) {
      EXPECT_FALSE(record.holds(time, source));
      Observation& look = record.insert(time, source);
      EXPECT_EQ(look.time, time);
      EXPECT_EQ(look.source, source);
      EXPECT_TRUE(look.detections.empty()) << "of one that was there before";
      EXPECT_FALSE(look.counted);
      look.detections.emplace_back();
      look.counted = true;
      EXPECT_TRUE(record.holds(time, source));
    }
    ASSERT_EQ(looks_of(record), sorted);
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_FALSE(record.holds(instant(0), 2));
  EXPECT_FALSE(record.holds(instant(2), 1));
}

TEST(StepRecord, RestartsWithTracksOnly) {
  StepRecord record(3, 4);
  TrackTable tracks(3);
  tracks.put(known_track(1, 2.0));
  record.received_at_end.put({0, {}, 1.0});
  record.received_at_start.put({2, {}, 1.0});
  record.received_labels.emplace_back();
  record.has_belief_of_end = true;
  record.insert(instant(1), 0);
  record.start(instant(2), instant(3), tracks);
  EXPECT_EQ(record.from, instant(2));
  EXPECT_EQ(record.to, instant(3));
  EXPECT_EQ(ids_of(record.before), std::vector{1});
  EXPECT_EQ(record.received_at_end.begin(), record.received_at_end.end());
  EXPECT_EQ(record.received_at_start.begin(), record.received_at_start.end());
  EXPECT_TRUE(record.received_labels.empty());
  EXPECT_FALSE(record.has_belief_of_end);
  EXPECT_EQ(record.observation_count, 0);
  EXPECT_FALSE(record.holds(instant(1), 0));
}

TEST(StepRecord, HasCapacityForASmallTeam) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  const auto room_of = [](int targets, int looks) {
    const StepRecord record(targets, looks);
    std::size_t room = 0;
    for (const Observation& look : record.observations) {
      EXPECT_EQ(look.detections.capacity(), record.observations.front().detections.capacity());
      room += look.detections.capacity();
    }
    return room;
  };
  EXPECT_EQ(room_of(10, 8), 80U);
  EXPECT_EQ(room_of(64, 8), StepRecord::kDetectionsReserved);
  EXPECT_EQ(room_of(1000, 8), StepRecord::kDetectionsReserved) << "a large team costs no more";
  EXPECT_EQ(room_of(5, 0), 0U);
  EXPECT_GE(StepRecord::kDetectionsReserved, 512U);
}

}  // namespace
}  // namespace vantage::estimator
