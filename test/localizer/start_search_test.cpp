#include "localizer/start_search.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "localizer/sighting_model.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::localizer {
namespace {

scenario::LocalizerSpec hall() {
  scenario::LocalizerSpec spec;
  spec.landmarks = {{7, {4.0, 1.0}}, {8, {5.0, -1.0}}, {9, {4.5, 0.2}}};
  spec.robots.resize(1);
  spec.robots[0].sightings = {true, 1.02, 0.05, 0.01, 0.0, 0.05, 0.0};
  return spec;
}

models::Sighting seen(const scenario::LocalizerSpec& spec, const Pose2& pose, int landmark,
                      int reported_id) {
  const ExpectedSighting expected =
      expected_sighting(spec.robots[0].sightings, pose,
                        spec.landmarks[static_cast<std::size_t>(landmark)].position_m);
  return {{}, reported_id, expected.range_m, expected.bearing_rad};
}

/// Drives `steps` steps past the landmarks of hall() and returns the first pose that the search
/// finds, relative to the true pose. `wrong`: step whose sightings have a wrong id; −1: none.
std::optional<Pose2> error_of_search(const std::vector<int>& landmarks, int steps, int wrong) {
  const scenario::LocalizerSpec spec = hall();
  StartSearch search;
  Pose2 truth{-1.0, 0.3, -0.1};
  const Eigen::Vector3d increment(0.05, 0.0, 0.01);
  for (int step = 0; step < steps; ++step) {
    truth = truth * Pose2{increment.x(), increment.y(), increment.z()};
    search.advance(0.1, increment);
    std::vector<models::Sighting> frame;
    for (const int landmark : landmarks) {
      frame.push_back(
          seen(spec, truth, landmark, step == wrong ? 7 + (landmark + 1) % 3 : 7 + landmark));
    }
    if (const auto found = search.observe(spec, 0, frame)) {
      return inverse(truth) * found->world_from_body;
    }
  }
  return std::nullopt;
}

TEST(StartSearch, FindsPoseFromTwoLandmarks) {
  const auto error = error_of_search({0, 1}, 20, -1);
  ASSERT_TRUE(error);
  EXPECT_LT(error->position_m().norm(), 1e-9);
  EXPECT_LT(std::abs(error->yaw_rad), 1e-9);
}

TEST(StartSearch, FindsNothingFromOneLandmark) { EXPECT_FALSE(error_of_search({0}, 200, -1)); }

TEST(StartSearch, IgnoresSightingsWithWrongIds) {
  const auto error = error_of_search({0, 1, 2}, 20, 0);
  ASSERT_TRUE(error);
  EXPECT_LT(error->position_m().norm(), 1e-9);
}

TEST(StartSearch, AllocatesNothing) {
  const scenario::LocalizerSpec spec = hall();
  const std::vector<models::Sighting> frame = {seen(spec, {}, 0, 7), seen(spec, {}, 1, 8)};
  StartSearch search;
  const test::AllocationCounter allocations;
  for (int i = 0; i < 100; ++i) {
    search.advance(0.1, {0.0, 0.0, 0.0});
    static_cast<void>(search.observe(spec, 0, frame));
  }
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace vantage::localizer
