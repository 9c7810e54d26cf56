// Measures cells per second on one core: information of a beam by CSQMI and by FSMI, and
// information of ray-traced views.
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "models/mapping/beam_information.hpp"
#include "planner/mapping/view_table.hpp"
#include "test/support/random.hpp"

namespace vantage {
namespace {

const models::BeamSensor kSensor{48, 2.0 * kPi, 0.0, 1e3, 0.01};

// Returns beams of `cells` uncertain cells of 0.1 m.
std::vector<models::BeamProfile> doubtful_beams(int cells) {
  test::Random random(1);
  std::vector<models::BeamProfile> beams(64);
  for (models::BeamProfile& beam : beams) {
    for (int k = 0; k < cells; ++k) {
      beam.push_back(k, random.uniform(0.02, 0.3), 0.1 * (k + 1), 0.1 * (k + 2));
    }
  }
  return beams;
}

template <class Measure>
void measure_beams(benchmark::State& state, const Measure& measure) {
  const std::vector<models::BeamProfile> beams = doubtful_beams(static_cast<int>(state.range(0)));
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(measure(beams[k++ % beams.size()]));
  }
  state.counters["cells/s"] = benchmark::Counter(
      static_cast<double>(state.iterations() * state.range(0)), benchmark::Counter::kIsRate);
}

void csqmi_linear(benchmark::State& state) {
  measure_beams(state, [](const auto& beam) { return models::csqmi(beam, kSensor).nats; });
}
void csqmi_all_pairs(benchmark::State& state) {
  measure_beams(state, [](const auto& beam) { return models::csqmi(beam, kSensor, 1e9).nats; });
}
void fsmi_linear(benchmark::State& state) {
  measure_beams(state, [](const auto& beam) { return models::fsmi(beam, kSensor, {}).nats; });
}
BENCHMARK(csqmi_linear)->Arg(8)->Arg(15)->Arg(100)->Arg(1000);
BENCHMARK(csqmi_all_pairs)->Arg(8)->Arg(15)->Arg(100)->Arg(1000);
BENCHMARK(fsmi_linear)->Arg(8)->Arg(15)->Arg(100)->Arg(1000);

// Measures ray tracing, information and the removal of dependent beams together, on an unknown map.
void views(benchmark::State& state) {
  const models::GridGeometry grid{{0.0, 0.0}, 0.1, 100, 100};
  const models::OccupancyBelief belief(grid, 4.0);
  planner::ViewOptions options;
  options.dependence = state.range(0) == 0 ? planner::BeamDependence::kBestOfCell
                                           : planner::BeamDependence::kDropBeams;
  std::int64_t cells = 0;
  for (auto _ : state) {
    planner::ViewTable table(belief, {48, 2.0 * kPi, 0.0, 1.5, 0.01}, options);
    for (int k = 0; k < 100; ++k) {
      const Eigen::Vector2d at_m = grid.centre_m(2020 + 60 * k);
      benchmark::DoNotOptimize(table.view({at_m.x(), at_m.y(), 0.0}).nats);
    }
    cells += table.beam_cells();
  }
  state.counters["cells/s"] =
      benchmark::Counter(static_cast<double>(cells), benchmark::Counter::kIsRate);
}
BENCHMARK(views)->Arg(0)->Arg(1);

}  // namespace
}  // namespace vantage

BENCHMARK_MAIN();
