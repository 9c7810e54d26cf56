#include "localizer/frame_assignment.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "localizer/sighting_model.hpp"

namespace vantage::localizer {
namespace {

/// Scene with landmarks at the given positions (ids 10, 11, …) and sightings of some of them.
struct Scene {
  explicit Scene(const std::vector<Eigen::Vector2d>& positions_m) {
    for (const Eigen::Vector2d& position_m : positions_m) {
      bodies.push_back({10 + static_cast<int>(bodies.size()), false, position_m});
    }
  }
  /// Adds a sighting of a point without an id, from `pose`.
  void see(const Pose2& pose, const Eigen::Vector2d& point_m) {
    const ExpectedSighting expected = expected_sighting(sensor, pose, point_m);
    sightings.push_back({{}, kNoBodyId, expected.range_m, expected.bearing_rad});
  }
  [[nodiscard]] std::vector<int> assigned(const Eigen::Vector3d& sigma) const {
    std::vector<int> ids;
    for (const models::Sighting& sighting : sightings) {
      ids.push_back(sighting.id);
    }
    const Eigen::Matrix3d P = sigma.cwiseProduct(sigma).asDiagonal();
    assign_frame({sensor, noise, bodies, sightings}, {{}, P}, ids);
    return ids;
  }
  scenario::SightingSpec sensor;
  scenario::SightingNoiseSpec noise;
  std::vector<CandidateBody> bodies;
  std::vector<models::Sighting> sightings;
};

constexpr double kSmall = 0.01;
const Eigen::Vector3d kCertain(kSmall, kSmall, kSmall);

TEST(FrameAssignment, FindsBodiesOfCertainObserver) {
  Scene scene({{2.0, 0.0}, {3.0, 1.0}, {3.0, -1.0}});
  scene.see({}, {3.0, -1.0});
  scene.see({}, {2.0, 0.0});
  EXPECT_EQ(scene.assigned(kCertain), (std::vector<int>{12, 10}));
}

TEST(FrameAssignment, FindsConsistentAssignmentWhenHeadingIsUncertain) {
  // With the mean heading, each sighting is nearest to another landmark than the true one.
  Scene scene({{3.0, 0.9}, {3.0, 0.0}, {3.0, -0.9}, {5.0, 2.4}});
  const Pose2 truth{0.0, 0.0, 0.2};
  for (const CandidateBody& body : scene.bodies) {
    scene.see(truth, body.position_m);
  }
  EXPECT_EQ(scene.assigned({kSmall, kSmall, 0.2}), (std::vector<int>{10, 11, 12, 13}));
}

TEST(FrameAssignment, MarksSightingBetweenTwoBodiesAsAmbiguous) {
  Scene scene({{3.0, 0.2}, {3.0, -0.2}});
  scene.see({}, {3.0, 0.0});
  EXPECT_EQ(scene.assigned({0.1, 0.1, 0.1}), (std::vector<int>{kAmbiguousId}));
}

TEST(FrameAssignment, LeavesSightingOfNoBodyUnassigned) {
  Scene scene({{3.0, 0.0}});
  scene.see({}, {2.0, 1.0});
  EXPECT_EQ(scene.assigned(kCertain), (std::vector<int>{kNoBodyId}));
  scene.see({}, {3.0, 0.0});
  EXPECT_EQ(scene.assigned(kCertain), (std::vector<int>{kNoBodyId, 10}));
}

TEST(FrameAssignment, KeepsGivenIdsAndAssignsEachBodyOnce) {
  Scene scene({{3.0, 0.0}});
  scene.see({}, {3.0, 0.0});
  scene.see({}, {3.0, 0.0});
  scene.sightings[0].id = 10;
  const std::vector<int> ids = scene.assigned(kCertain);
  EXPECT_EQ(ids[0], 10);
}

TEST(FrameAssignment, AssignsNothingWithoutBodies) {
  Scene scene({});
  scene.see({}, {3.0, 0.0});
  EXPECT_EQ(scene.assigned(kCertain), (std::vector<int>{kNoBodyId}));
}

}  // namespace
}  // namespace vantage::localizer
