#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"
#include "wire/vicon/rotation.hpp"

namespace vantage::wire::vicon {
namespace {

using test::is_near;

Eigen::Matrix3d product_of_turns(const Eigen::Vector3d& euler_rad) {
  return (Eigen::AngleAxisd(euler_rad.x(), Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(euler_rad.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(euler_rad.z(), Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

TEST(RotationFromEulerXyz, IsTheProductOfRotationsAboutMovingAxes) {
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d euler = random.vector<3>(-7.0, 7.0);
    const Eigen::Matrix3d R = rotation_from_euler_xyz(euler).toRotationMatrix();
    EXPECT_TRUE(is_near(R, product_of_turns(euler), 1e-14));
    // Reference values of Vicon's angle convention.
    EXPECT_NEAR(R(0, 2), std::sin(euler.y()), 1e-14);
    EXPECT_NEAR(R(1, 2), -std::sin(euler.x()) * std::cos(euler.y()), 1e-14);
    EXPECT_NEAR(R(0, 1), -std::cos(euler.y()) * std::sin(euler.z()), 1e-14);
  }
}

TEST(EulerXyzFromRotation, InvertsRotationFromEulerXyzAlsoAtGimbalLock) {
  test::Random random(2);
  for (int i = 0; i < 3000; ++i) {
    Eigen::Vector3d euler = random.vector<3>(-kPi, kPi);
    if (i % 3 == 0) {
      const double off = i % 2 == 0 ? 0.0 : std::pow(10.0, random.uniform(-16.0, -3.0));
      euler.y() = (random.coin() ? 1.0 : -1.0) * (kPi / 2.0 - off);
    }
    const Eigen::Quaterniond R = rotation_from_euler_xyz(euler);
    const Eigen::Vector3d back = euler_xyz_from_rotation(R);
    EXPECT_TRUE(is_near(product_of_turns(back), R.toRotationMatrix(), 1e-14)) << euler.transpose();
  }
}

TEST(RotationFromMatrix, RefusesMatricesThatAreNotRotations) {
  const Eigen::Matrix3d R = product_of_turns({0.3, -1.2, 2.0});
  ASSERT_TRUE(rotation_from_matrix(R));
  EXPECT_TRUE(is_near(rotation_from_matrix(R)->toRotationMatrix(), R, 1e-14));
  EXPECT_FALSE(rotation_from_matrix(-R)) << "changes handedness";
  EXPECT_FALSE(rotation_from_matrix(1.01 * R));
  EXPECT_FALSE(rotation_from_matrix(Eigen::Matrix3d::Zero()));
  for (Eigen::Index entry = 0; entry < 9; ++entry) {
    Eigen::Matrix3d one_bad = R;
    one_bad(entry) = std::nan("");
    EXPECT_FALSE(rotation_from_matrix(one_bad)) << entry;
  }
}

TEST(RotationFromXyzw, RefusesNonUnitQuaternions) {
  ASSERT_TRUE(rotation_from_xyzw(0.0, 0.0, 0.6, 0.8));
  EXPECT_EQ(rotation_from_xyzw(0.0, 0.0, 0.6, 0.8)->w(), 0.8);
  EXPECT_FALSE(rotation_from_xyzw(0.0, 0.0, 0.0, 0.0));
  EXPECT_FALSE(rotation_from_xyzw(0.0, 0.0, 0.6, 0.9));
  EXPECT_FALSE(rotation_from_xyzw(std::nan(""), 0.0, 0.6, 0.8));
}

// Quaternions with a norm that differs from 1 by less than 10⁻³ are accepted and normalised. The
// order of the elements is preserved.
TEST(RotationFromXyzw, NormalisesNearlyUnitQuaternions) {
  const Eigen::Vector4d xyzw = Eigen::Vector4d(0.1, -0.3, 0.5, 0.7).normalized();
  for (const double off : {-0.95e-3, -1e-9, 0.0, 1e-9, 0.95e-3}) {
    const Eigen::Vector4d q = (1.0 + off) * xyzw;
    const auto rotation = rotation_from_xyzw(q.x(), q.y(), q.z(), q.w());
    ASSERT_TRUE(rotation) << off;
    EXPECT_TRUE(is_near(rotation->coeffs(), xyzw, 1e-15)) << off;
  }
  for (const double off : {-1.05e-3, 1.05e-3}) {
    const Eigen::Vector4d q = (1.0 + off) * xyzw;
    EXPECT_FALSE(rotation_from_xyzw(q.x(), q.y(), q.z(), q.w())) << off;
  }
}

// For a scaled rotation, RᵀR is (1 + off)·I. For a sheared one, RᵀR has `off` next to its diagonal.
TEST(RotationFromMatrix, OrthonormalisesMatricesThatAreNearlyRotations) {
  const Eigen::Matrix3d R = product_of_turns({0.3, -1.2, 2.0});
  for (const double off : {-1.05e-3, -0.95e-3, 0.95e-3, 1.05e-3}) {
    const auto scaled = rotation_from_matrix(std::sqrt(1.0 + off) * R);
    Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
    shear(0, 2) = off;
    const auto sheared = rotation_from_matrix(R * shear);
    EXPECT_EQ(scaled.has_value(), std::abs(off) < 1e-3) << off;
    EXPECT_EQ(sheared.has_value(), std::abs(off) < 1e-3) << off;
    if (scaled && sheared) {
      EXPECT_TRUE(is_near(scaled->toRotationMatrix(), R, 1e-3));
      EXPECT_NEAR(scaled->norm(), 1.0, 1e-15);
      EXPECT_TRUE(is_near(sheared->toRotationMatrix(), R, 1e-3));
      EXPECT_NEAR(sheared->norm(), 1.0, 1e-15);
    }
  }
}

TEST(EulerXyzFromRotation, ReturnsAnglesInRange) {
  test::Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d euler(random.uniform(-kPi, kPi), random.uniform(-1.57, 1.57),
                                random.uniform(-kPi, kPi));
    EXPECT_TRUE(is_near(euler_xyz_from_rotation(rotation_from_euler_xyz(euler)), euler, 1e-9));
  }
}

TEST(ZUpFromYUp, MapsTheReferencePoint) {
  const Pose3 y_up{{0.989, 0.145, 1.020}, Eigen::Quaterniond::Identity()};
  const Pose3 z_up = z_up_from_y_up(y_up);
  EXPECT_TRUE(is_near(z_up.translation_m, Eigen::Vector3d(0.989, -1.020, 0.145), 0.0));
  EXPECT_TRUE(is_near(z_up.rotation.toRotationMatrix(), Eigen::Matrix3d::Identity(), 1e-15));
}

TEST(ZUpFromYUp, KeepsRotationsAboutTheVertical) {
  const Pose3 y_up{Eigen::Vector3d::Zero(),
                   Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY()))};
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(is_near(z_up_from_y_up(y_up).rotation.toRotationMatrix(), turn, 1e-15));
}

TEST(ZUpFromYUp, CommutesWithComposition) {
  test::Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Pose3 a = random.pose3(2.0);
    const Pose3 b = random.pose3(2.0);
    const Pose3 together = z_up_from_y_up(a * b);
    const Pose3 apart = z_up_from_y_up(a) * z_up_from_y_up(b);
    EXPECT_TRUE(is_near(together.translation_m, apart.translation_m, 1e-14));
    EXPECT_LT(together.rotation.angularDistance(apart.rotation), 1e-7);
    const Pose3 back = y_up_from_z_up(z_up_from_y_up(a));
    EXPECT_TRUE(is_near(back.translation_m, a.translation_m, 1e-15));
    EXPECT_TRUE(is_near(back.rotation.coeffs(), a.rotation.coeffs(), 1e-15));
  }
}

}  // namespace
}  // namespace vantage::wire::vicon
