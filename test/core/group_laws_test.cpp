#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/pose.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

// Tests the same laws on every group of rigid motions. Poses are compared as homogeneous matrices,
// which share no code with the groups under test.

namespace vantage {
namespace {

struct Se2 {
  using Pose = Pose2;
  using Point = Eigen::Vector2d;
  static Eigen::MatrixXd matrix(const Pose& pose) {
    Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
    T.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(pose.yaw_rad).toRotationMatrix();
    T.topRightCorner<2, 1>() = pose.position_m();
    return T;
  }
  static Pose pose(test::Random& random) { return random.pose2(5.0); }
  static Point point(test::Random& random) { return random.vector<2>(-5.0, 5.0); }
};

struct Se3 {
  using Pose = Pose3;
  using Point = Eigen::Vector3d;
  static Eigen::MatrixXd matrix(const Pose& pose) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix();
    T.topRightCorner<3, 1>() = pose.translation_m;
    return T;
  }
  static Pose pose(test::Random& random) { return random.pose3(5.0); }
  static Point point(test::Random& random) { return random.vector<3>(-5.0, 5.0); }
};

template <class Group>
class RigidMotion : public ::testing::Test {
 protected:
  typename Group::Pose pose() { return Group::pose(random_); }
  test::Random random_{7};
};
using Groups = ::testing::Types<Se2, Se3>;
TYPED_TEST_SUITE(RigidMotion, Groups);

TYPED_TEST(RigidMotion, ComposesLikeHomogeneousMatrices) {
  for (int i = 0; i < 1000; ++i) {
    const auto a = this->pose();
    const auto b = this->pose();
    ASSERT_TRUE(test::is_near(TypeParam::matrix(a * b),
                              (TypeParam::matrix(a) * TypeParam::matrix(b)).eval(), 1e-12));
  }
}

TYPED_TEST(RigidMotion, IsAssociative) {
  for (int i = 0; i < 1000; ++i) {
    const auto a = this->pose();
    const auto b = this->pose();
    const auto c = this->pose();
    ASSERT_TRUE(
        test::is_near(TypeParam::matrix((a * b) * c), TypeParam::matrix(a * (b * c)), 1e-12));
  }
}

TYPED_TEST(RigidMotion, IsUndoneByItsInverseOnBothSides) {
  const Eigen::MatrixXd I = TypeParam::matrix(typename TypeParam::Pose{});
  for (int i = 0; i < 1000; ++i) {
    const auto a = this->pose();
    ASSERT_TRUE(test::is_near(TypeParam::matrix(a * inverse(a)), I, 1e-12));
    ASSERT_TRUE(test::is_near(TypeParam::matrix(inverse(a) * a), I, 1e-12));
  }
}

TYPED_TEST(RigidMotion, ProductMovesPointsLikeSuccessiveMotions) {
  for (int i = 0; i < 1000; ++i) {
    const auto a = this->pose();
    const auto b = this->pose();
    const auto p = TypeParam::point(this->random_);
    ASSERT_TRUE(test::is_near((a * b) * p, a * (b * p), 1e-12));
  }
}

}  // namespace
}  // namespace vantage
