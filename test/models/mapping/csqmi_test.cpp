#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "models/mapping/beam_information.hpp"
#include "test/models/mapping/enumerated_beam.hpp"

namespace vantage::models {
namespace {

using test::EnumeratedBeam;

BeamProfile beam_of(const std::vector<double>& occupancies, double width_m) {
  BeamProfile beam;
  for (const double o : occupancies) {
    const int k = beam.size();
    beam.push_back(k, o, width_m * (k + 1), width_m * (k + 2));
  }
  return beam;
}

// Computes the definition by enumerating all maps: −log of the squared Cauchy–Schwarz ratio of p(m,
// z) and p(m) p(z).
double csqmi_by_enumeration(const EnumeratedBeam& beam) {
  double joint = 0.0;
  double apart = 0.0;
  double cross = 0.0;
  for (const EnumeratedBeam::Map& map : beam.maps()) {
    const double pp = map.probability * map.probability;
    joint += pp * beam.integral([&](double z) { return std::pow(beam.density(map, z), 2); });
    cross += pp * beam.integral([&](double z) { return beam.density(map, z) * beam.density(z); });
    apart += pp;
  }
  apart *= beam.integral([&](double z) { return std::pow(beam.density(z), 2); });
  return std::log(joint) + std::log(apart) - 2.0 * std::log(cross);
}

// Computes the closed form as published, with w_l and the product over all cells.
double csqmi_as_printed(const BeamProfile& beam, const BeamSensor& sensor) {
  const std::size_t cells = beam.occupancy.size();
  const auto square = [](double o) { return o * o + (1.0 - o) * (1.0 - o); };
  std::vector<double> p(cells + 1, 1.0);  // index 0: no hit
  std::vector<double> w(cells + 1, 1.0);
  std::vector<double> mu_m(cells + 1, sensor.range_max_m);
  double product = 1.0;
  for (std::size_t l = 1; l <= cells; ++l) {
    const double o = beam.occupancy[l - 1];
    mu_m[l] = sensor.mean_range_m(0.5 * (beam.enter_m[l - 1] + beam.exit_m[l - 1]));
    p[l] = p[0] * o;
    p[0] *= 1.0 - o;
    product *= square(o);
  }
  w[0] = p[0] * p[0];
  for (std::size_t l = 1; l <= cells; ++l) {
    w[l] = p[l] * p[l];
    for (std::size_t j = l + 1; j <= cells; ++j) {
      w[l] *= square(beam.occupancy[j - 1]);
    }
  }
  const auto N = [&](double d_m) {
    const double variance = 2.0 * sensor.sigma_m * sensor.sigma_m;
    return std::exp(-0.5 * d_m * d_m / variance) / std::sqrt(2.0 * std::numbers::pi * variance);
  };
  double first = 0.0;
  double second = 0.0;
  double third = 0.0;
  for (std::size_t l = 0; l <= cells; ++l) {
    first += w[l] * N(0.0);
    for (std::size_t j = 0; j <= cells; ++j) {
      second += p[j] * p[l] * N(mu_m[l] - mu_m[j]);
      third += p[j] * w[l] * N(mu_m[l] - mu_m[j]);
    }
  }
  return std::log(first) + std::log(product * second) - 2.0 * std::log(third);
}

TEST(Csqmi, IsOneBitForOneUnknownCell) {
  const BeamSensor sensor{1, 1.0, 0.0, 10.0, 0.01};
  EXPECT_NEAR(csqmi(beam_of({0.5}, 1.0), sensor).nats, std::log(2.0), 1e-12);
}

TEST(Csqmi, EqualsClosedFormForOneCell) {
  // Hit probabilities p = (o, 1 − o) and weights w = (o², (1 − o)²)/s, s = o² + (1 − o)²: I = log s
  // − 2 log((o³ + (1 − o)³)/s).
  const BeamSensor sensor{1, 1.0, 0.0, 10.0, 0.01};
  for (const double o : {0.01, 0.2, 0.7, 0.999}) {
    const double s = o * o + (1.0 - o) * (1.0 - o);
    const double cubes = std::pow(o, 3) + std::pow(1.0 - o, 3);
    EXPECT_NEAR(csqmi(beam_of({o}, 1.0), sensor).nats, 3.0 * std::log(s) - 2.0 * std::log(cubes),
                1e-12);
  }
}

TEST(Csqmi, EqualsTheSumOverAllMaps) {
  test::Random random(4201);
  for (int i = 0; i < 200; ++i) {
    const BeamSensor sensor{1, 1.0, random.coin() ? 0.0 : 0.4, random.uniform(0.8, 2.5),
                            random.uniform(0.02, 0.4)};
    const BeamProfile beam = test::random_beam(random, 8, 0.02, 0.3);
    const EnumeratedBeam oracle(beam, sensor);
    const BeamInformation computed = csqmi(beam, sensor, 1e9);
    ASSERT_EQ(computed.error_nats, 0.0);
    ASSERT_NEAR(computed.nats, csqmi_by_enumeration(oracle), 1e-6) << i;
  }
}

TEST(Csqmi, EqualsThePublishedClosedForm) {
  test::Random random(4202);
  for (int i = 0; i < 2'000; ++i) {
    const BeamSensor sensor{1, 1.0, 0.0, random.uniform(0.5, 4.0), random.uniform(0.01, 0.3)};
    const BeamProfile beam = test::random_beam(random, 30, 0.02, 0.3);
    ASSERT_NEAR(csqmi(beam, sensor, 1e9).nats, csqmi_as_printed(beam, sensor), 1e-9) << i;
  }
}

TEST(Csqmi, TruncationErrorIsWithinItsBound) {
  test::Random random(4203);
  double worst_share = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const BeamSensor sensor{1, 1.0, 0.0, random.uniform(0.5, 6.0), random.uniform(0.02, 0.3)};
    const BeamProfile beam = test::random_beam(random, 40, 0.02, 0.3);
    const BeamInformation cut = csqmi(beam, sensor, random.uniform(0.5, 8.0));
    const double off_nats = std::abs(cut.nats - csqmi(beam, sensor, 1e9).nats);
    ASSERT_LE(off_nats, cut.error_nats + 1e-12) << i;
    worst_share = std::max(worst_share, cut.error_nats > 0.0 ? off_nats / cut.error_nats : 0.0);
  }
  EXPECT_GT(worst_share, 0.05) << "otherwise the bound is trivial";
}

TEST(Csqmi, TruncationErrorIsBelowOneTenMillionth) {
  test::Random random(4204);
  for (int i = 0; i < 1'000; ++i) {
    const BeamSensor sensor{1, 1.0, 0.0, 6.0, 0.01};
    const BeamProfile beam = test::random_beam(random, 40, 0.02, 0.3);
    ASSERT_LT(csqmi(beam, sensor).error_nats, 1e-7);
  }
}

TEST(Csqmi, IsNonNegativeAndZeroForCertainCells) {
  test::Random random(4205);
  for (int i = 0; i < 20'000; ++i) {
    const BeamSensor sensor{1, 1.0, 0.0, random.uniform(0.3, 6.0), random.uniform(0.001, 0.5)};
    BeamProfile beam = test::random_beam(random, 40, 0.001, 0.3);
    ASSERT_GE(csqmi(beam, sensor).nats, 0.0);
    for (double& o : beam.occupancy) {
      o = o < 0.5 ? 0.0 : 1.0;
    }
    ASSERT_NEAR(csqmi(beam, sensor).nats, 0.0, 1e-12);
  }
  EXPECT_EQ(csqmi({}, BeamSensor{}).nats, 0.0);
}

TEST(Csqmi, IgnoresCellsBehindAnOccupiedCell) {
  test::Random random(4206);
  const BeamSensor sensor{1, 1.0, 0.0, 5.0, 0.01};
  for (int i = 0; i < 200; ++i) {
    BeamProfile beam = test::random_beam(random, 6, 0.1, 0.2);
    beam.push_back(90, 1.0, beam.exit_m.back(), beam.exit_m.back() + 0.1);
    const double to_the_wall_nats = csqmi(beam, sensor).nats;
    beam.push_back(91, 0.5, beam.exit_m.back(), beam.exit_m.back() + 0.1);
    beam.push_back(92, 0.3, beam.exit_m.back(), beam.exit_m.back() + 0.1);
    ASSERT_NEAR(csqmi(beam, sensor).nats, to_the_wall_nats, 1e-12);
  }
}

TEST(Csqmi, IsFiniteForTenThousandUnknownCells) {
  const BeamSensor sensor{1, 1.0, 0.0, 1001.0, 0.01};
  const BeamProfile beam = beam_of(std::vector<double>(10'000, 0.5), 0.1);
  // At o = ½ hit probabilities and weights are 2^−j, so I = −log Σ 4^−j = log 3.
  EXPECT_NEAR(csqmi(beam, sensor).nats, std::log(3.0), 1e-9);
}

}  // namespace
}  // namespace vantage::models
