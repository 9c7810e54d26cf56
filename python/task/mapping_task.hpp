#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/mapping_trial.hpp"
#include "python/task/team_task.hpp"

namespace vantage::python {

/// A team that explores: it maps a world of which it knows nothing but the walls around it. The
/// defaults are the source's (dissertation 4 F.2) with fewer robots.
struct MappingTaskSpec {
  int robots = 2;
  std::string world = "pillars";  ///< or "corridors"
  double side_m = 16.0;
  int patch_cells = 32;  ///< side of the part of the map around a robot that it is told
  int episode_steps = 100;
  JammerSpec jammer;
};

/// Reward: nats that the map's entropy fell by. A robot drives as far as the world allows.
class MappingTask final : public TeamTask {
 public:
  /// @throws UsageError for a spec that makes no sense, naming the rule.
  explicit MappingTask(const MappingTaskSpec& spec);

  [[nodiscard]] int actions() const override {
    return static_cast<int>(setup_.search.controls.size());
  }
  /// "self" (5), "teammates" (robots − 1, 4), "map" (patch_cells, patch_cells): rows from south to
  /// north, columns from west to east about the robot's cell, 2 P(occupied) − 1; 1 outside.
  [[nodiscard]] std::vector<ObservationPart> observation_parts() const override;
  [[nodiscard]] int observation_size() const override;
  void observe(int robot, std::span<float> out) const override;
  using TeamTask::observe;
  [[nodiscard]] double entropy_nats() const override { return entropy_nats_; }

  [[nodiscard]] const experiments::MappingSetup& setup() const { return setup_; }
  /// Of this episode. Precondition: reset() was called.
  [[nodiscard]] const experiments::MappedWorld& ground() const { return *ground_; }

 private:
  void on_reset(std::uint64_t seed) override;
  double on_step(std::span<const std::int64_t> actions) override;
  void look();
  /// Brings cell_nats_ up to date within the reach of `robot`; by how much the entropy fell.
  double learn_around(std::size_t robot);

  MappingTaskSpec spec_;
  experiments::MappingSetup setup_;
  std::optional<experiments::MappedWorld> ground_;
  std::vector<double> cell_log_odds_;  ///< that cell_nats_ is of
  std::vector<double> cell_nats_;
  double entropy_nats_ = 0.0;
  std::vector<int> attacked_;
};

}  // namespace vantage::python
