#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/mapping/mapping_trial.hpp"
#include "python/task/team_task.hpp"

namespace vantage::python {

/// Exploration by a team that initially knows only the outer walls of its world. The defaults are
/// those of the dissertation (section 4.F.2), but with fewer robots.
struct MappingTaskSpec {
  int robots = 2;
  std::string world = "pillars";  ///< "pillars" or "corridors"
  double side_m = 16.0;
  int patch_cells = 32;  ///< cells; side of the map section that a robot observes
  int episode_steps = 100;
  JammerSpec jammer;
};

/// Mapping task. The reward is the decrease of the map's entropy, nats. Robots stop at obstacles.
class MappingTask final : public TeamTask {
 public:
  /// @throws UsageError for an invalid spec; the text states the rule.
  explicit MappingTask(const MappingTaskSpec& spec);

  [[nodiscard]] int actions() const override {
    return static_cast<int>(setup_.search.controls.size());
  }
  /// Returns the parts "self" (5), "teammates" (robots − 1, 4) and "map" (patch_cells,
  /// patch_cells). The map has the robot's cell in the middle, rows from south to north and columns
  /// from west to east. Its entries are 2 P(occupied) − 1, and 1 outside the world.
  [[nodiscard]] std::vector<ObservationPart> observation_parts() const override;
  [[nodiscard]] int observation_size() const override;
  void observe(int robot, std::span<float> out) const override;
  using TeamTask::observe;
  [[nodiscard]] double entropy_nats() const override { return entropy_nats_; }

  [[nodiscard]] const experiments::MappingSetup& setup() const { return setup_; }
  /// Returns the world of the current episode. Precondition: reset() was called.
  [[nodiscard]] const experiments::MappedWorld& ground() const { return *ground_; }

 private:
  void on_reset(std::uint64_t seed) override;
  double on_step(std::span<const std::int64_t> actions) override;
  void update_beliefs();
  /// Updates cell_nats_ within the sensor range of `robot`. Returns the decrease of the map's
  /// entropy, nats.
  double learn_around(std::size_t robot);

  MappingTaskSpec spec_;
  experiments::MappingSetup setup_;
  std::optional<experiments::MappedWorld> ground_;
  std::vector<double> cell_log_odds_;  ///< log-odds for which cell_nats_ was computed
  std::vector<double> cell_nats_;
  double entropy_nats_ = 0.0;
  std::vector<int> attacked_;
};

}  // namespace vantage::python
