#include "scenario/team_algorithm.hpp"

#include <array>

namespace vantage::scenario {
namespace {

constexpr TeamAlgorithmRow kTeamRows[] = {{"coordinate_descent", false}, {"local_search", true}};

}  // namespace

constinit const TeamAlgorithm TeamAlgorithm::kCoordinateDescent(kTeamRows[0]);
constinit const TeamAlgorithm TeamAlgorithm::kLocalSearch(kTeamRows[1]);

std::span<const TeamAlgorithm> all_team_algorithms() {
  static constexpr std::array kAll{TeamAlgorithm(kTeamRows[0]), TeamAlgorithm(kTeamRows[1])};
  return kAll;
}

}  // namespace vantage::scenario
