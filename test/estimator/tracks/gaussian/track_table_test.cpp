#include "estimator/tracks/gaussian/track_table.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "models/belief/gaussian.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::estimator {
namespace {

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

}  // namespace
}  // namespace vantage::estimator
