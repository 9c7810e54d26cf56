#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "models/mapping/beam_information.hpp"
#include "test/models/mapping/enumerated_beam.hpp"

namespace vantage::models {
namespace {

using test::EnumeratedBeam;

double divergence_nats(double posterior, double prior) {
  const auto part = [](double p, double q) { return p > 0.0 ? p * std::log(p / q) : 0.0; };
  return part(posterior, prior) + part(1.0 - posterior, 1.0 - prior);
}

// Returns the information change by a reading z, summed over the cells, as documented at fsmi().
double information_change(const BeamProfile& beam, const BeamSensor& sensor,
                          const InverseBeamModel& inverse, double z_m) {
  double sum_nats = 0.0;
  const bool is_hit = z_m < sensor.no_hit_range_m() && z_m < beam.exit_m.back();
  if (is_hit && z_m < beam.enter_m.front()) {
    return 0.0;
  }
  for (std::size_t k = 0; k < beam.occupancy.size(); ++k) {
    const double o = beam.occupancy[k];
    const bool is_here = is_hit && z_m >= beam.enter_m[k] && z_m < beam.exit_m[k];
    if (is_hit && z_m < beam.enter_m[k]) {
      break;
    }
    if (o > 0.0 && o < 1.0) {
      const double l = is_here ? inverse.hit_log_odds : inverse.miss_log_odds;
      sum_nats += divergence_nats(probability_of(log_odds_of(o) + l), o);
    }
  }
  return sum_nats;
}

// Returns ∫ p(z) information_change(z) dz, with p(z) from all maps. The integrand is constant
// between cell edges.
double fsmi_by_enumeration(const BeamProfile& beam, const BeamSensor& sensor,
                           const InverseBeamModel& inverse) {
  const EnumeratedBeam oracle(beam, sensor);
  std::vector<double> edges_m = beam.enter_m;
  edges_m.push_back(beam.exit_m.back());
  edges_m.push_back(sensor.no_hit_range_m());
  edges_m.push_back(-10.0);
  edges_m.push_back(20.0);
  std::sort(edges_m.begin(), edges_m.end());
  double sum_nats = 0.0;
  for (std::size_t k = 0; k + 1 < edges_m.size(); ++k) {
    double inside = 0.0;  // P(z in this interval)
    for (const EnumeratedBeam::Map& map : oracle.maps()) {
      const auto cdf = [&](double z_m) {
        return 0.5 * std::erfc((map.mean_range_m - z_m) / sensor.sigma_m / std::sqrt(2.0));
      };
      inside += map.probability * (cdf(edges_m[k + 1]) - cdf(edges_m[k]));
    }
    sum_nats +=
        inside * information_change(beam, sensor, inverse, 0.5 * (edges_m[k] + edges_m[k + 1]));
  }
  return sum_nats;
}

// Returns I(m; z) = Σ_m p(m) ∫ p(z|m) log(p(z|m)/p(z)) dz.
double shannon_by_enumeration(const EnumeratedBeam& beam) {
  return beam.integral([&](double z_m) {
    const double density = beam.density(z_m);
    double sum_nats = 0.0;
    for (const EnumeratedBeam::Map& map : beam.maps()) {
      const double given = beam.density(map, z_m);
      sum_nats += map.probability > 0.0 && given > 0.0
                      ? map.probability * given * std::log(given / density)
                      : 0.0;
    }
    return sum_nats;
  });
}

TEST(Fsmi, EqualsExpectedDivergenceForOneCell) {
  const BeamSensor sensor{1, 1.0, 0.0, 10.0, 0.01};
  const InverseBeamModel inverse{std::log(9.0), -std::log(9.0)};
  BeamProfile beam;
  beam.push_back(0, 0.5, 1.0, 2.0);
  EXPECT_NEAR(fsmi(beam, sensor, inverse).nats, divergence_nats(0.9, 0.5), 1e-12);
}

TEST(Fsmi, EqualsTheSumOverAllMaps) {
  test::Random random(4301);
  for (int i = 0; i < 1'000; ++i) {
    const BeamSensor sensor{1, 1.0, random.coin() ? 0.0 : 0.4, random.uniform(0.8, 2.5),
                            random.uniform(0.01, 0.4)};
    const BeamProfile beam = test::random_beam(random, 8, 0.02, 0.3);
    const InverseBeamModel inverse{random.uniform(0.1, 4.0), -random.uniform(0.1, 4.0)};
    ASSERT_NEAR(fsmi(beam, sensor, inverse).nats, fsmi_by_enumeration(beam, sensor, inverse), 1e-9)
        << i;
  }
}

TEST(Fsmi, EqualsShannonInformationForNoiselessReadings) {
  test::Random random(4302);
  const BeamSensor sensor{1, 1.0, 0.0, 3.0, 0.002};
  const InverseBeamModel certain{40.0, -40.0};
  for (int i = 0; i < 100; ++i) {
    const BeamProfile beam = test::random_beam(random, 8, 0.05, 0.3);
    const EnumeratedBeam oracle(beam, sensor);
    ASSERT_NEAR(fsmi(beam, sensor, certain).nats, shannon_by_enumeration(oracle), 1e-6) << i;
  }
}

TEST(Fsmi, TruncationErrorIsWithinItsBound) {
  test::Random random(4303);
  for (int i = 0; i < 5'000; ++i) {
    const BeamSensor sensor{1, 1.0, 0.0, random.uniform(0.5, 6.0), random.uniform(0.02, 0.3)};
    const BeamProfile beam = test::random_beam(random, 40, 0.02, 0.3);
    const BeamInformation cut = fsmi(beam, sensor, {}, random.uniform(0.5, 6.0));
    ASSERT_NEAR(cut.nats, fsmi(beam, sensor, {}, 30.0).nats, cut.error_nats + 1e-12) << i;
  }
}

TEST(Fsmi, IsNonNegativeAndZeroForCertainCells) {
  test::Random random(4304);
  for (int i = 0; i < 5'000; ++i) {
    const BeamSensor sensor{1, 1.0, 0.0, random.uniform(0.3, 6.0), random.uniform(0.001, 0.1)};
    BeamProfile beam = test::random_beam(random, 40, 0.001, 0.3);
    ASSERT_GE(fsmi(beam, sensor, {}).nats, -1e-12);
    for (double& o : beam.occupancy) {
      o = o < 0.5 ? 0.0 : 1.0;
    }
    ASSERT_EQ(fsmi(beam, sensor, {}).nats, 0.0);
  }
  EXPECT_EQ(fsmi({}, BeamSensor{}, {}).nats, 0.0);
}

TEST(BeamInformation, RanksBeamsEquallyByBothMeasures) {
  test::Random random(4305);
  const BeamSensor sensor{1, 1.0, 0.0, 1.5, 0.01};
  int agree = 0;
  int pairs = 0;
  for (int i = 0; i < 5'000; ++i) {
    const BeamProfile a = test::random_beam(random, 8, 0.1, 0.2);
    const BeamProfile b = test::random_beam(random, 8, 0.1, 0.2);
    ++pairs;
    agree += (csqmi(a, sensor).nats < csqmi(b, sensor).nats) ==
                     (fsmi(a, sensor, {}).nats < fsmi(b, sensor, {}).nats)
                 ? 1
                 : 0;
  }
  EXPECT_GT(agree, 0.8 * pairs);
}

}  // namespace
}  // namespace vantage::models
