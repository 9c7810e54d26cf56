#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/pose.hpp"
#include "models/mapping/beam_information.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::planner {

/// Information measure of one beam.
enum class BeamMeasure {
  kCsqmi,  ///< Cauchy–Schwarz quadratic mutual information
  kFsmi,   ///< Shannon mutual information
};

/// Handling of beams that observe the same cells. Both modes divide a beam's information among its
/// cells in proportion to P(beam reaches the cell) · o (1 − o), with the occupancy o of the cell.
enum class BeamDependence {
  /// Drops a beam if other counted beams already give at least `dependent_share` of its
  /// information; otherwise counts it in full. The result depends on the order of the beams. From
  /// Charrow et al.
  kDropBeams,
  /// Counts for each cell only the beam with the most information: Σ_cells max_beams. Independent
  /// of order, monotone and submodular in the set of beams, so the guarantees of team planning
  /// hold.
  kBestOfCell,
};

struct ViewOptions {
  BeamMeasure measure = BeamMeasure::kCsqmi;
  BeamDependence dependence = BeamDependence::kBestOfCell;
  double dependent_share = 0.5;  ///< share in (0, 1], for kDropBeams
  double cutoff_sigmas = 6.0;    ///< cutoff of Gaussian products; at 6 σ: e^−9 of the peak
  models::InverseBeamModel inverse = {};  ///< inverse sensor model, for kFsmi
};

/// Information of one scan from one position. Information that several beams of the scan share is
/// not counted twice.
struct BeamView {
  struct Share {
    int cell = 0;
    double nats = 0.0;
  };
  struct Beam {
    double nats = 0.0;
    std::uint32_t begin = 0;  ///< the shares of the beam's cells are shares[begin … end)
    std::uint32_t end = 0;
  };
  double nats = 0.0;  ///< sum; upper bound of the gain in addition to any other scans
  std::vector<Beam> beams;
  std::vector<Share> shares;
};

/// Store of the best information about each cell from a set of scans. Additions can be undone in
/// reverse order.
class MapCoverage {
 public:
  explicit MapCoverage(int cells) : credited_nats_(static_cast<std::size_t>(cells), 0.0) {}

  /// Adds `view`; returns the increase of information, in [0, view.nats].
  double add(const BeamView& view, const ViewOptions& options);
  /// Returns the present state's mark, to which undo_to() can return.
  [[nodiscard]] std::size_t mark() const { return undo_.size(); }
  void undo_to(std::size_t mark);

 private:
  struct Undo {
    int cell = 0;
    double nats = 0.0;
  };
  std::vector<double> credited_nats_;
  std::vector<Undo> undo_;
};

/// Cache of the views of one belief; each view is computed at its first query.
///
/// A view is taken from the centre of the robot's cell. With a full-circle field of view, its beams
/// have fixed world bearings. With a smaller one, its heading is rounded to 1/(4 · beams) of a
/// circle. Positions within a cell differ by less than half its diagonal, and a team's searches
/// query the same cells many times. `belief` must outlive this object and not change.
class ViewTable {
 public:
  /// Throws UsageError for an invalid sensor or invalid options.
  ViewTable(const models::OccupancyBelief& belief, const models::BeamSensor& sensor,
            const ViewOptions& options);

  /// Returns the view from `world_from_body`; an empty one outside the grid. The reference is valid
  /// for the table's lifetime.
  const BeamView& view(const Pose2& world_from_body);

  [[nodiscard]] const ViewOptions& options() const { return options_; }
  [[nodiscard]] const models::OccupancyBelief& belief() const { return *belief_; }
  [[nodiscard]] std::int64_t beam_cells() const { return beam_cells_; }
  [[nodiscard]] std::int64_t views() const { return static_cast<std::int64_t>(views_.size()); }

 private:
  [[nodiscard]] BeamView look(const Eigen::Vector2d& from_m, double yaw_rad);

  const models::OccupancyBelief* belief_;
  models::BeamSensor sensor_;
  ViewOptions options_;
  int sectors_ = 1;              ///< number of distinct headings
  std::int64_t beam_cells_ = 0;  ///< number of cells of all computed beams, a measure of the work
  MapCoverage within_;           ///< coverage within one scan
  models::BeamProfile profile_;
  std::vector<double> weight_;  ///< weight of each cell of the beam
  std::unordered_map<std::int64_t, BeamView> views_;
};

}  // namespace vantage::planner
