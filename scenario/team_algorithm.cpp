#include "scenario/team_algorithm.hpp"

#include <array>

namespace vantage::scenario {
namespace {

constexpr TeamAlgorithmRow kRows[] = {{"coordinate_descent", false}, {"local_search", true}};

}  // namespace

constinit const TeamAlgorithm TeamAlgorithm::kCoordinateDescent(kRows[0]);
constinit const TeamAlgorithm TeamAlgorithm::kLocalSearch(kRows[1]);

std::span<const TeamAlgorithm> all_team_algorithms() {
  static constexpr std::array kAll{TeamAlgorithm(kRows[0]), TeamAlgorithm(kRows[1])};
  return kAll;
}

}  // namespace vantage::scenario
