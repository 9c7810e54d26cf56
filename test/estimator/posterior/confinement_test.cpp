#include "estimator/posterior/confinement.hpp"

#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

namespace vantage::estimator {
namespace {

using models::Gaussian;
using vantage::test::is_near;

const models::World kRoom{{{-4.0, -2.0}, {4.0, 2.0}}, 3.0, {{{{1.0, -1.0}, {2.0, 0.0}}, 2.0}}, {}};

TEST(Confinement, ChangesNothingFarFromWallsAndObstacles) {
  const Gaussian belief{Eigen::Vector2d(-1.5, 0.0), 0.01 * Eigen::Matrix2d::Identity()};
  const Gaussian after = confine(belief, kRoom);
  EXPECT_EQ(after.mean, belief.mean);
  EXPECT_EQ(after.covariance, belief.covariance);
}

TEST(Confinement, EqualsTheTruncatedNormalAtAWall) {
  // Only the wall at x = 4 is near. N(4 + aσ, σ²) is truncated to u < −a: mean −λ with λ =
  // φ(a)/Φ(−a), variance 1 + aλ − λ². The wall is midway between two columns of the product rule.
  const double sigma_m = 0.2;
  const double a = 0.217;
  const Gaussian belief{Eigen::Vector2d(4.0 + a * sigma_m, 0.0),
                        sigma_m * sigma_m * Eigen::Matrix2d::Identity()};
  const Gaussian after = confine(belief, kRoom);
  const double lambda =
      std::exp(-0.5 * a * a) / std::sqrt(2.0 * kPi) / (0.5 * std::erfc(a / std::sqrt(2.0)));
  EXPECT_NEAR((after.mean(0) - belief.mean(0)) / sigma_m, -lambda, 0.03);
  EXPECT_NEAR(after.covariance(0, 0) / (sigma_m * sigma_m), 1.0 + a * lambda - lambda * lambda,
              0.03);
  EXPECT_NEAR(after.mean(1), 0.0, 1e-9);
}

TEST(Confinement, EqualsSampledMomentsAroundAnObstacle) {
  std::mt19937_64 rng(11);
  std::normal_distribution<double> normal;
  for (const double x_m : {1.8, 1.5, 0.7}) {
    const double sigma_m = 0.6;
    const Gaussian belief{Eigen::Vector2d(x_m, -0.6),
                          sigma_m * sigma_m * Eigen::Matrix2d::Identity()};
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    int kept = 0;
    for (int i = 0; i < 200'000; ++i) {
      const Eigen::Vector2d p_m = belief.mean + sigma_m * Eigen::Vector2d(normal(rng), normal(rng));
      if (models::clearance_m(kRoom, p_m) < 0.0) {
        continue;
      }
      sum += p_m;
      squares += p_m * p_m.transpose();
      ++kept;
    }
    const Eigen::Vector2d mean_m = sum / kept;
    const Eigen::Matrix2d covariance_m2 = squares / kept - mean_m * mean_m.transpose();
    const Gaussian after = confine(belief, kRoom);
    EXPECT_TRUE(is_near(after.mean, mean_m, 0.1 * sigma_m)) << x_m;
    EXPECT_TRUE(is_near(after.covariance, covariance_m2, 0.1 * sigma_m * sigma_m)) << x_m;
  }
}

TEST(Confinement, TendsToTheCentreOfTheRoomWithoutMeasurements) {
  const models::World room{kRoom.bounds, 3.0, {}, {}};
  Gaussian belief{Eigen::Vector2d(3.9, -1.9), 0.01 * Eigen::Matrix2d::Identity()};
  for (int step = 0; step < 400; ++step) {
    belief.covariance += 0.15 * Eigen::Matrix2d::Identity();
    belief = confine(belief, room);
  }
  EXPECT_TRUE(is_near(belief.mean, Eigen::Vector2d::Zero(), 0.02));
  // The uniform distribution is the widest limit of a confined diffusion.
  EXPECT_LT(belief.covariance(0, 0), 64.0 / 12.0);
  EXPECT_LT(belief.covariance(1, 1), 16.0 / 12.0);
  // A diffusion that never leaves the room tends to the density cos(πx/L), of variance L² (1/12 −
  // 1/(2π²)). Gaussian beliefs and steps of 0.5 s only approximate this diffusion.
  const double ground_mode = 1.0 / 12.0 - 1.0 / (2.0 * kPi * kPi);
  EXPECT_NEAR(belief.covariance(0, 0), 64.0 * ground_mode, 0.25 * 64.0 * ground_mode);
}

TEST(Confinement, KeepsBeliefsDefiniteAndMeansInside) {
  std::mt19937_64 rng(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(rng);
  };
  const models::World room{kRoom.bounds, 3.0, {}, {}};
  int changed = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Index dim = i % 2 == 0 ? 2 : 4;
    Gaussian belief;
    belief.mean = models::StateVector::Zero(dim);
    belief.mean(0) = uniform(-5.0, 5.0);
    belief.mean(1) = uniform(-3.0, 3.0);
    models::StateMatrix root = models::StateMatrix::Zero(dim, dim);
    for (Eigen::Index r = 0; r < dim; ++r) {
      for (Eigen::Index c = 0; c < dim; ++c) {
        root(r, c) = uniform(-1.0, 1.0);
      }
    }
    belief.covariance = root * root.transpose() + 0.01 * models::StateMatrix::Identity(dim, dim);
    const Gaussian after = confine(belief, room);
    ASSERT_EQ(Eigen::LLT<Eigen::MatrixXd>(after.covariance).info(), Eigen::Success) << i;
    if (after.mean == belief.mean) {
      continue;
    }
    ++changed;
    ASSERT_TRUE(room.bounds.contains(after.mean.head<2>())) << i;
  }
  EXPECT_GT(changed, 200);
}

TEST(Confinement, AppliesToATeammatesBeliefOfTheLastStep) {
  // The target is reflected during the step. A belief without this reflection would have a more
  // certain velocity and would dominate the fusion.
  for (const bool samples : {false, true}) {
    FilterSpec spec = test::open_spec({models::TargetKind::kDoubleIntegrator, 2, 0.001},
                                      test::far_sighted(models::SensorKind::kPosition), 1);
    spec.estimator.targets_stay_inside = true;
    spec.estimator.samples = samples;
    spec.communication_range_m = 100.0;
    Gaussian leaving{Eigen::Vector4d(19.75, 0.0, 0.8, 0.0), Eigen::Matrix4d::Zero()};
    leaving.covariance.diagonal() << 0.0025, 0.0025, 0.04, 0.04;  // 1/12 of the belief stays inside
    DistributedFilter filter(spec);
    filter.rebase(test::prior(test::instant(0), {leaving}));
    models::RobotBelief of_before = test::prior(test::instant(0), {leaving});
    of_before.robot = "Q2";
    models::RobotBelief of_now = test::prior(test::instant(1), {});
    of_now.robot = "Q3";
    test::take_step(filter, test::instant(1), test::at(0, 0), {}, {of_before, of_now});
    EXPECT_NEAR(test::known(filter, 0).mean(0), 19.85, 0.02) << samples;
    EXPECT_LT(test::known(filter, 0).mean(2), -0.5) << samples;
  }
}

TEST(Confinement, AppliesToATeammatesBeliefOfTwoStepsAgo) {
  FilterSpec spec = test::open_spec({models::TargetKind::kDoubleIntegrator, 2, 0.001},
                                    test::far_sighted(models::SensorKind::kPosition), 1);
  spec.estimator.targets_stay_inside = true;
  spec.communication_range_m = 100.0;
  Gaussian leaving{Eigen::Vector4d(19.75, 0.0, 0.8, 0.0), Eigen::Matrix4d::Zero()};
  leaving.covariance.diagonal() << 0.0025, 0.0025, 0.04, 0.04;
  DistributedFilter filter(spec);
  filter.rebase(test::prior(test::instant(0), {leaving}));
  models::RobotBelief of_before = test::prior(test::instant(0), {leaving});
  of_before.robot = "Q2";
  test::take_step(filter, test::instant(1), test::at(0, 0), {});
  test::take_step(filter, test::instant(2), test::at(0, 0), {}, {of_before});
  EXPECT_NEAR(test::known(filter, 0).mean(0), 19.85 - 0.35, 0.06);
  EXPECT_LT(test::known(filter, 0).mean(2), -0.5);
}

TEST(Confinement, KeepsTheFilterInsideWhenATargetIsLostAtTheWall) {
  models::TargetModel walk{models::TargetKind::kRandomWalk, 2, 0.3};
  models::SensorModel position;
  position.kind = models::SensorKind::kPosition;
  const auto after_a_minute = [&](bool stay_inside) {
    FilterSpec spec = test::open_spec(walk, position, 1);
    spec.estimator.targets_stay_inside = stay_inside;
    spec.world.bounds = kRoom.bounds;
    DistributedFilter filter(spec);
    filter.rebase(test::prior(test::instant(0),
                              {{Eigen::Vector2d(3.9, 1.9), 0.01 * Eigen::Matrix2d::Identity()}}));
    for (int step = 1; step <= 120; ++step) {
      filter.advance({test::instant(step), test::at(0, 0), {}, {}});
    }
    return models::to_gaussian(filter.track(0).information).value();
  };
  EXPECT_TRUE(is_near(after_a_minute(false).mean, Eigen::Vector2d(3.9, 1.9), 1e-9));
  EXPECT_NEAR(after_a_minute(false).covariance(0, 0), 0.01 + 0.3 * 60.0, 1e-9);
  EXPECT_LT(after_a_minute(true).mean.norm(), 0.2);
  EXPECT_LT(after_a_minute(true).covariance.trace(), 64.0 / 12.0 + 16.0 / 12.0);
}

TEST(Reflection, ChangesNothingFarFromWalls) {
  Gaussian belief{models::StateVector(Eigen::Vector4d(1.0, -0.5, 0.3, 0.2)),
                  0.01 * Eigen::Matrix4d::Identity()};
  const Gaussian after = reflect(belief, kRoom.bounds);
  EXPECT_EQ(after.mean, belief.mean);
  EXPECT_EQ(after.covariance, belief.covariance);
}

TEST(Reflection, EqualsTheFoldedNormalAtAWall) {
  // y = L − |x − L| with x ~ N(L + aσ, σ²): E|x − L| = σ (2 φ(a) + a (1 − 2 Φ(−a))); a velocity
  // that is not correlated with x is reversed with probability p = Φ(a).
  const double sigma_m = 0.2;
  const double velocity_mps = 0.4;
  for (const double a : {-2.0, -0.9, 0.1, 0.7, 1.8, 4.5}) {
    Gaussian belief;
    belief.mean = Eigen::Vector4d(4.0 + a * sigma_m, 0.3, velocity_mps, -0.1);
    belief.covariance = Eigen::Vector4d(sigma_m * sigma_m, 0.01, 0.0025, 0.0049).asDiagonal();
    const Gaussian after = reflect(belief, kRoom.bounds);
    const double density = std::exp(-0.5 * a * a) / std::sqrt(2.0 * kPi);
    const double beyond = 0.5 * std::erfc(-a / std::sqrt(2.0));
    const double away_m = sigma_m * (2.0 * density + a * (2.0 * beyond - 1.0));
    EXPECT_NEAR(after.mean(0), 4.0 - away_m, 0.05 * sigma_m) << a;
    EXPECT_NEAR(after.covariance(0, 0), sigma_m * sigma_m * (1.0 + a * a) - away_m * away_m,
                0.05 * sigma_m * sigma_m)
        << a;
    const double kept = 1.0 - 2.0 * beyond;
    EXPECT_NEAR(after.mean(2), kept * velocity_mps, 0.2 * velocity_mps) << a;
    const double mean_mps = after.mean(2);
    EXPECT_NEAR(after.covariance(2, 2), 0.0025 + velocity_mps * velocity_mps - mean_mps * mean_mps,
                1e-9)
        << a;
    EXPECT_NEAR(after.mean(1), 0.3, 1e-12) << a;
    EXPECT_NEAR(after.mean(3), -0.1, 1e-12) << a;
    EXPECT_NEAR(after.covariance(3, 3), 0.0049, 1e-12) << a;
  }
}

// A belief entirely beyond a wall is mirrored, including its velocity correlations. This applies at
// each wall, in the corners, and over several reflections.
TEST(Reflection, MirrorsABeliefBeyondAWall) {
  std::mt19937_64 rng(17);
  for (int i = 0; i < 100; ++i) {
    Gaussian inside;
    inside.mean = Eigen::Vector4d(i % 3 == 0   ? 0.0
                                  : i % 3 == 1 ? 3.6
                                               : -3.6,
                                  i % 4 < 2 ? (i % 2 == 0 ? 1.7 : -1.7) : 0.0, 0.4, -0.3);
    const Eigen::Matrix4d root = Eigen::Matrix4d::NullaryExpr(
        [&] { return std::generate_canonical<double, 53>(rng) - 0.5; });
    Eigen::Matrix4d scale = Eigen::Vector4d(0.02, 0.02, 0.3, 0.3).asDiagonal();
    inside.covariance =
        scale * (root * root.transpose()) * scale + 1e-6 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d signs = Eigen::Vector4d::Ones();
    Gaussian beyond = inside;
    if (inside.mean(0) != 0.0) {
      beyond.mean(0) = std::copysign(8.0, inside.mean(0)) - inside.mean(0);
      signs(0) = signs(2) = -1.0;
    }
    if (inside.mean(1) != 0.0) {
      beyond.mean(1) = std::copysign(4.0, inside.mean(1)) - inside.mean(1);
      signs(1) = signs(3) = -1.0;
    }
    const int rounds = i / 12 % 5 - 2;  // to the opposite wall and back
    beyond.mean(0) += 16.0 * rounds;
    beyond.mean(1) += 8.0 * rounds;
    beyond.mean(2) *= signs(2);
    beyond.mean(3) *= signs(3);
    beyond.covariance = signs.asDiagonal() * inside.covariance * signs.asDiagonal();
    const Gaussian after = reflect(beyond, kRoom.bounds);
    EXPECT_TRUE(is_near(after.mean, inside.mean, 1e-9)) << i;
    EXPECT_TRUE(is_near(after.covariance, inside.covariance, 1e-9)) << i;
  }
}

TEST(Reflection, EqualsSampledMomentsInACorner) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix4d root;
  root << 1.5, 0.0, 0.0, 0.0, 0.4, 1.1, 0.0, 0.0, 0.3, -0.1, 0.2, 0.0, 0.1, 0.25, 0.05, 0.3;
  const Eigen::Vector4d mean(3.2, 1.4, 0.5, 0.3);
  const Gaussian after = reflect(
      {models::StateVector(mean), models::StateMatrix(root * root.transpose())}, kRoom.bounds);
  const auto back = [](double& x, double& v, double low, double high) {
    while (x < low || x > high) {
      x = x < low ? 2.0 * low - x : 2.0 * high - x;
      v = -v;
    }
  };
  constexpr int kSamples = 400'000;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    Eigen::Vector4d z =
        mean + root * Eigen::Vector4d(normal(rng), normal(rng), normal(rng), normal(rng));
    back(z(0), z(2), -4.0, 4.0);
    back(z(1), z(3), -2.0, 2.0);
    sum += z;
    squares += z * z.transpose();
  }
  const Eigen::Vector4d expected = sum / kSamples;
  const Eigen::Matrix4d covariance = squares / kSamples - expected * expected.transpose();
  // The tolerance covers the columns of the product rule, which are 0.6 m apart; the velocity's
  // sign changes between two columns.
  EXPECT_TRUE(is_near(after.mean, expected, 0.1));
  EXPECT_TRUE(is_near(after.covariance, covariance, 0.1));
}

TEST(Inset, IsTheSpaceForTheCentreOfADisc) {
  const models::World world{{{-4.0, -2.0}, {4.0, 2.0}}, 3.0, {{{{1.0, 0.0}, {2.0, 1.0}}, 2.5}}, {}};
  const models::World room = inset(world, 0.2);
  EXPECT_EQ(room.bounds.min_m, Eigen::Vector2d(-3.8, -1.8));
  EXPECT_EQ(room.bounds.max_m, Eigen::Vector2d(3.8, 1.8));
  EXPECT_EQ(room.obstacles.front().footprint.min_m, Eigen::Vector2d(0.8, -0.2));
  EXPECT_EQ(room.obstacles.front().footprint.max_m, Eigen::Vector2d(2.2, 1.2));
  EXPECT_EQ(inset(world, 2.0).bounds.max_m, world.bounds.max_m);  // unchanged: no space is left
}

// A target is reflected when its edge touches the wall, with its centre one radius before the wall.
TEST(Reflection, IsAtTheTargetsRadiusFromTheWall) {
  FilterSpec spec = test::open_spec({models::TargetKind::kDoubleIntegrator, 2, 1e-6},
                                    test::far_sighted(models::SensorKind::kRangeBearing), 1);
  spec.estimator.targets_stay_inside = true;
  spec.target_radius_m = 0.2;
  DistributedFilter filter(spec);
  Gaussian belief{Eigen::Vector4d(19.0, 0.0, 1.0, 0.0), 1e-4 * Eigen::Matrix4d::Identity()};
  filter.rebase(test::prior(test::instant(0), {belief}));
  for (int k = 1; k <= 4; ++k) {
    test::take_step(filter, test::instant(k), test::at(0.0, 0.0), {});
  }
  const Gaussian later = test::known(filter, 0);
  EXPECT_NEAR(later.mean(0), 18.6, 0.02);  // 19 + 2, reflected at 19.8
  EXPECT_NEAR(later.mean(2), -1.0, 0.02);
}

// The simulated targets are reflected at the walls, in steps of 20 ms, and are observed at the
// start only.
TEST(Reflection, KeepsTheFilterConsistentAtTheWall) {
  const models::TargetModel drift{models::TargetKind::kDoubleIntegrator, 2, 0.001};
  std::mt19937_64 rng(21);
  std::normal_distribution<double> normal;
  const models::Rectangle field{{-32.0, -32.0}, {32.0, 32.0}};
  const Eigen::Vector4d sigma(0.2, 0.2, 0.05, 0.05);
  const auto mean_nees = [&](bool stay_inside, double* worst) {
    constexpr int kTargets = 200;
    double sum = 0.0;
    for (int i = 0; i < kTargets; ++i) {
      const Eigen::Vector4d start(28.0, 5.0, 0.4, -0.1);
      Eigen::Vector4d truth = start;
      for (int k = 0; k < 4; ++k) {
        truth(k) += sigma(k) * normal(rng);
      }
      models::SensorModel position;
      position.kind = models::SensorKind::kPosition;
      FilterSpec spec = test::open_spec(drift, position, 1);
      spec.estimator.targets_stay_inside = stay_inside;
      spec.world.bounds = field;
      DistributedFilter filter(spec);
      filter.rebase(test::prior(
          test::instant(0),
          {{models::StateVector(start), models::StateMatrix(sigma.cwiseAbs2().asDiagonal())}}));
      for (int step = 1; step <= 60; ++step) {
        for (int k = 0; k < 25; ++k) {
          truth.tail<2>() += std::sqrt(0.001 * 0.02) * Eigen::Vector2d(normal(rng), normal(rng));
          truth.head<2>() += 0.02 * truth.tail<2>();
          if (std::abs(truth(0)) > 32.0) {
            truth(0) = std::copysign(64.0, truth(0)) - truth(0);
            truth(2) = -truth(2);
          }
        }
        filter.advance({test::instant(step), test::at(0, 0), {}, {}});
      }
      const Gaussian belief = models::to_gaussian(filter.track(0).information).value();
      const Eigen::Vector2d error = truth.head<2>() - belief.mean.head<2>();
      const Eigen::Matrix2d P = belief.covariance.topLeftCorner<2, 2>();
      const double nees = error.dot(P.llt().solve(error));
      *worst = std::max(*worst, nees);
      sum += nees;
    }
    return sum / kTargets;
  };
  double worst = 0.0;
  const double honest = mean_nees(true, &worst);
  EXPECT_GT(honest, 0.5);
  EXPECT_LT(honest, 3.0);  // 2 if the truth were Gaussian
  EXPECT_LT(worst, 30.0);
  EXPECT_GT(mean_nees(false, &worst), 5.0);  // otherwise the test proves nothing
}

// A corridor of width 0 has no interior, so beliefs are not reflected.
TEST(Reflection, ChangesNothingBetweenCoincidentWalls) {
  Gaussian belief;
  belief.mean = Eigen::Vector4d(3.9, 2.1, 0.4, -0.3);
  belief.covariance = 0.25 * Eigen::Matrix4d::Identity();
  for (const models::Rectangle& none :
       {models::Rectangle{{-4.0, 2.0}, {4.0, 2.0}}, models::Rectangle{{3.0, -2.0}, {3.0, 2.0}},
        models::Rectangle{{-4.0, 2.0}, {4.0, 1.0}}}) {
    const Gaussian after = reflect(belief, none);
    EXPECT_EQ(after.mean, belief.mean);
    EXPECT_EQ(after.covariance, belief.covariance);
  }
}

}  // namespace
}  // namespace vantage::estimator
