#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/pose.hpp"
#include "models/mapping/beam_information.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::planner {

/// What a beam is worth by itself.
enum class BeamMeasure {
  kCsqmi,  ///< Cauchy–Schwarz quadratic mutual information
  kFsmi,   ///< Shannon mutual information
};

/// How beams that look at the same cells are counted. Both work on what a beam tells of each of
/// its cells: its information, parted in proportion to P(beam comes to the cell) · o (1 − o).
enum class BeamDependence {
  /// A beam goes wholly when at least `dependent_share` of it is told by beams that count already,
  /// and counts wholly otherwise. Charrow et al.; depends on the order of the beams.
  kDropBeams,
  /// Of each cell only the beam that tells most of it counts: Σ_cells max_beams. Independent of
  /// order, monotone and submodular in the set of beams, so the guarantees of team planning hold.
  kBestOfCell,
};

struct ViewOptions {
  BeamMeasure measure = BeamMeasure::kCsqmi;
  BeamDependence dependence = BeamDependence::kBestOfCell;
  double dependent_share = 0.5;           ///< of kDropBeams, in (0, 1]
  double cutoff_sigmas = 6.0;             ///< e^−9 of a Gaussian product's peak is let go
  models::InverseBeamModel inverse = {};  ///< of kFsmi
};

/// What a scan from some place would tell, with the beams that depend on each other inside the
/// scan removed.
struct BeamView {
  struct Share {
    int cell = 0;
    double nats = 0.0;
  };
  struct Beam {
    double nats = 0.0;
    std::uint32_t begin = 0;  ///< its cells are shares[begin … end)
    std::uint32_t end = 0;
  };
  double nats = 0.0;  ///< of all; an upper bound of what it adds to whatever else is seen
  std::vector<Beam> beams;
  std::vector<Share> shares;
};

/// The cells that a set of scans tells of, and how much the best of them tells of each. What has
/// been added can be taken back, last first.
class MapCoverage {
 public:
  explicit MapCoverage(int cells) : told_nats_(static_cast<std::size_t>(cells), 0.0) {}

  /// Adds `view`; returns by how much the information rises, in [0, view.nats].
  double add(const BeamView& view, const ViewOptions& options);
  /// A place to come back to.
  [[nodiscard]] std::size_t mark() const { return undo_.size(); }
  void take_back(std::size_t mark);

 private:
  struct Undo {
    int cell = 0;
    double nats = 0.0;
  };
  std::vector<double> told_nats_;
  std::vector<Undo> undo_;
};

/// The views of one belief, each worked out when it is first asked for.
///
/// Planning looks from the middle of the cell that the robot is in, with the beams at fixed
/// bearings of the world (a full circle) or the heading rounded to the spacing of the beams (less
/// than that): places within a cell differ by less than half its diagonal, and a team's searches
/// come to the same cells many times. `belief` must outlive this and not change.
class ViewTable {
 public:
  /// Throws UsageError for a sensor or options that make no sense.
  ViewTable(const models::OccupancyBelief& belief, const models::BeamSensor& sensor,
            const ViewOptions& options);

  /// The view from `world_from_body`; an empty one outside the grid. The reference is good for
  /// the table's life.
  const BeamView& view(const Pose2& world_from_body);

  [[nodiscard]] const ViewOptions& options() const { return options_; }
  [[nodiscard]] const models::OccupancyBelief& belief() const { return *belief_; }
  [[nodiscard]] const models::BeamSensor& sensor() const { return sensor_; }
  [[nodiscard]] std::int64_t beam_cells() const { return beam_cells_; }
  [[nodiscard]] std::int64_t views() const { return static_cast<std::int64_t>(views_.size()); }

 private:
  [[nodiscard]] BeamView look(const Eigen::Vector2d& from_m, double yaw_rad);

  const models::OccupancyBelief* belief_;
  models::BeamSensor sensor_;
  ViewOptions options_;
  int sectors_ = 1;              ///< headings that are told apart
  std::int64_t beam_cells_ = 0;  ///< cells of all beams so far: the work done
  MapCoverage within_;           ///< of one scan
  models::BeamProfile profile_;
  std::vector<double> weight_;  ///< per cell of the beam
  std::unordered_map<std::int64_t, BeamView> views_;
};

}  // namespace vantage::planner
