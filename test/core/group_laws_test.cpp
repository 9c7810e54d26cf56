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
  using Twist = Eigen::Vector3d;
  using Point = Eigen::Vector2d;
  static Pose exp(const Twist& twist) { return exp_se2(twist); }
  static Twist log(const Pose& pose) { return log_se2(pose); }
  static Eigen::MatrixXd matrix(const Pose& pose) {
    Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
    T.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(pose.yaw_rad).toRotationMatrix();
    T.topRightCorner<2, 1>() = pose.position_m();
    return T;
  }
  static Eigen::MatrixXd hat(const Twist& twist) {
    Eigen::Matrix3d X = Eigen::Matrix3d::Zero();
    X(0, 1) = -twist.z();
    X(1, 0) = twist.z();
    X.topRightCorner<2, 1>() = twist.head<2>();
    return X;
  }
  static Twist twist(test::Random& random, double turn_rad) {
    Twist twist = random.vector<3>(-5.0, 5.0);
    twist.z() = random.coin() ? turn_rad : -turn_rad;
    return twist;
  }
  static Point point(test::Random& random) { return random.vector<2>(-5.0, 5.0); }
};

struct Se3 {
  using Pose = Pose3;
  using Twist = Eigen::Matrix<double, 6, 1>;
  using Point = Eigen::Vector3d;
  static Pose exp(const Twist& twist) { return exp_se3(twist); }
  static Twist log(const Pose& pose) { return log_se3(pose); }
  static Eigen::MatrixXd matrix(const Pose& pose) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix();
    T.topRightCorner<3, 1>() = pose.translation_m;
    return T;
  }
  static Eigen::MatrixXd hat(const Twist& twist) {
    Eigen::Matrix4d X = Eigen::Matrix4d::Zero();
    X(0, 1) = -twist(5);
    X(0, 2) = twist(4);
    X(1, 0) = twist(5);
    X(1, 2) = -twist(3);
    X(2, 0) = -twist(4);
    X(2, 1) = twist(3);
    X.topRightCorner<3, 1>() = twist.head<3>();
    return X;
  }
  static Twist twist(test::Random& random, double turn_rad) {
    Twist twist = random.vector<6>(-5.0, 5.0);
    twist.tail<3>() = turn_rad * random.vector<3>(-1.0, 1.0).normalized();
    return twist;
  }
  static Point point(test::Random& random) { return random.vector<3>(-5.0, 5.0); }
};

// Computes the matrix exponential by its series, with scaling and squaring.
Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& X) {
  constexpr int kSquarings = 6;
  const Eigen::MatrixXd scaled = X / 64.0;
  Eigen::MatrixXd term = Eigen::MatrixXd::Identity(X.rows(), X.cols());
  Eigen::MatrixXd sum = term;
  for (int k = 1; k < 25; ++k) {
    term = term * scaled / k;
    sum += term;
  }
  for (int k = 0; k < kSquarings; ++k) {
    sum = sum * sum;
  }
  return sum;
}

template <class Group>
class RigidMotion : public ::testing::Test {
 protected:
  typename Group::Pose pose() { return Group::exp(Group::twist(random_, random_.uniform(0, 3.1))); }
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

TYPED_TEST(RigidMotion, ActsOnPointsInTurn) {
  for (int i = 0; i < 1000; ++i) {
    const auto a = this->pose();
    const auto b = this->pose();
    const auto p = TypeParam::point(this->random_);
    ASSERT_TRUE(test::is_near((a * b) * p, a * (b * p), 1e-12));
  }
}

TYPED_TEST(RigidMotion, IsTheMatrixExponentialOfItsTwist) {
  for (const double turn_rad : {0.0, 1e-12, 1e-7, 0.9e-6, 1.1e-6, 1e-4, 0.1, 1.0, 3.0, 3.141592}) {
    for (int i = 0; i < 100; ++i) {
      const auto twist = TypeParam::twist(this->random_, turn_rad);
      ASSERT_TRUE(test::is_near(TypeParam::matrix(TypeParam::exp(twist)),
                                matrix_exponential(TypeParam::hat(twist)), 2e-9))
          << "turn " << turn_rad;
    }
  }
}

TYPED_TEST(RigidMotion, ComesBackFromItsLogarithm) {
  for (const double turn_rad :
       {0.0, 1e-12, 1e-7, 0.9e-6, 1.1e-6, 1e-4, 0.1, 1.0, 3.0, kPi - 1e-4, kPi - 1e-8}) {
    for (int i = 0; i < 100; ++i) {
      const auto twist = TypeParam::twist(this->random_, turn_rad);
      ASSERT_TRUE(test::is_near(TypeParam::log(TypeParam::exp(twist)), twist, 2e-9))
          << "turn " << turn_rad;
    }
  }
}

TYPED_TEST(RigidMotion, OfExactlyHalfATurnHasALogarithmThatGivesItBack) {
  for (int i = 0; i < 100; ++i) {
    const auto pose = TypeParam::exp(TypeParam::twist(this->random_, kPi));
    const auto again = TypeParam::exp(TypeParam::log(pose));
    ASSERT_TRUE(test::is_near(TypeParam::matrix(again), TypeParam::matrix(pose), 1e-9));
  }
}

TYPED_TEST(RigidMotion, HeldTwiceAsLongIsItsSquare) {
  for (int i = 0; i < 1000; ++i) {
    const auto twist = TypeParam::twist(this->random_, this->random_.uniform(0.0, 1.5));
    const auto once = TypeParam::exp(twist);
    ASSERT_TRUE(test::is_near(TypeParam::matrix(TypeParam::exp(2.0 * twist)),
                              TypeParam::matrix(once * once), 1e-9));
  }
}

}  // namespace
}  // namespace vantage
