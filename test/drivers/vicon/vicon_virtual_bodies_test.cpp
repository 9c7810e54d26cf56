#include <gtest/gtest.h>

#include "drivers/vicon/virtual_bodies.hpp"

namespace vantage::drivers::vicon {
namespace {

constexpr Time kCapture = from_utime(1'700'000'000'000'000);

models::MocapFrame frame_with(const std::string& name) {
  models::MocapFrame frame;
  frame.stamp.time = kCapture;
  frame.bodies.push_back({name, lift({1.0, 2.0, 0.3}, 1.5), false});
  return frame;
}

models::TruthFrame truth_at(Time time) {
  models::TruthFrame truth;
  truth.stamp.time = time;
  truth.bodies.push_back({"R1", 0, lift({-1.0, 0.5, 0.0}, 0.0), {0.5, -0.25, 0.0}});
  truth.bodies.push_back({"Q1", -1, lift({3.0, 3.0, 0.0}, 1.0), {}});
  return truth;
}

TEST(VirtualBodies, DoNotChangeAFrameWithoutASimulator) {
  VirtualBodies bodies;
  models::MocapFrame frame = frame_with("Q1");
  bodies.add_to(frame);
  EXPECT_EQ(frame.bodies.size(), 1u);
}

TEST(VirtualBodies, AreExtrapolatedToTheFrameTime) {
  VirtualBodies bodies;
  bodies.on_truth(truth_at(kCapture - Duration{20'000}));
  models::MocapFrame frame = frame_with("Q2");
  bodies.add_to(frame);
  ASSERT_EQ(frame.bodies.size(), 3u);
  EXPECT_EQ(frame.bodies[0].name, "Q2");
  const models::MocapBody* const rover = frame.find("R1");
  ASSERT_NE(rover, nullptr);
  EXPECT_FALSE(rover->occluded);
  EXPECT_LT((rover->world_from_body.translation_m - Eigen::Vector3d(-0.99, 0.495, 0.0)).norm(),
            1e-12);
  bodies.on_truth(truth_at(kCapture + Duration{20'000}));  // 20 ms newer than the frame
  frame = frame_with("Q2");
  bodies.add_to(frame);
  EXPECT_NEAR(frame.find("R1")->world_from_body.translation_m.x(), -1.01, 1e-12);
}

TEST(VirtualBodies, YieldToRealBodiesOfTheSameName) {
  VirtualBodies bodies;
  bodies.on_truth(truth_at(kCapture));
  models::MocapFrame frame = frame_with("Q1");
  bodies.add_to(frame);
  ASSERT_EQ(frame.bodies.size(), 2u);
  EXPECT_EQ(frame.find("Q1")->world_from_body.translation_m.x(), 1.0);
  EXPECT_EQ(bodies.names_taken(), 1);
}

TEST(VirtualBodies, DisappearIfTruthAndFrameDifferByMoreThan200Ms) {
  VirtualBodies bodies;
  for (const Duration away : {Duration{-201'000}, Duration{201'000}, Duration{-86'400'000'000}}) {
    bodies.on_truth(truth_at(kCapture + away));
    models::MocapFrame frame = frame_with("Q2");
    bodies.add_to(frame);
    EXPECT_EQ(frame.bodies.size(), 1u);
  }
}

}  // namespace
}  // namespace vantage::drivers::vicon
