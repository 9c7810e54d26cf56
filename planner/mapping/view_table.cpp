#include "planner/mapping/view_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::planner {
namespace {

bool is_full_circle(const models::BeamSensor& sensor) {
  return sensor.field_of_view_rad >= 2.0 * kPi - 1e-12;
}

// Merges all beams into one that contains each informative cell of `from` once.
BeamView merged(const BeamView& from) {
  std::vector<BeamView::Share> shares = from.shares;
  std::sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.nats > b.nats;
  });
  shares.erase(std::unique(shares.begin(), shares.end(),
                           [](const auto& a, const auto& b) { return a.cell == b.cell; }),
               shares.end());
  BeamView view;
  for (const BeamView::Share& share : shares) {
    view.nats += share.nats;
  }
  view.shares = std::move(shares);
  view.beams.push_back({view.nats, 0, static_cast<std::uint32_t>(view.shares.size())});
  return view;
}

}  // namespace

double MapCoverage::add(const BeamView& view, const ViewOptions& options) {
  double gained_nats = 0.0;
  for (const BeamView::Beam& beam : view.beams) {
    if (options.dependence == BeamDependence::kDropBeams) {
      double credited_nats = 0.0;
      for (std::uint32_t k = beam.begin; k < beam.end; ++k) {
        const BeamView::Share& share = view.shares[k];
        credited_nats += std::min(share.nats, credited_nats_[index(share.cell)]);
      }
      if (credited_nats >= options.dependent_share * beam.nats) {
        continue;
      }
      gained_nats += beam.nats;
    }
    for (std::uint32_t k = beam.begin; k < beam.end; ++k) {
      const BeamView::Share& share = view.shares[k];
      double& credited_nats = credited_nats_[index(share.cell)];
      if (share.nats > credited_nats) {
        if (options.dependence == BeamDependence::kBestOfCell) {
          gained_nats += share.nats - credited_nats;
        }
        undo_.push_back({share.cell, credited_nats});
        credited_nats = share.nats;
      }
    }
  }
  return gained_nats;
}

void MapCoverage::undo_to(std::size_t mark) {
  while (undo_.size() > mark) {
    credited_nats_[index(undo_.back().cell)] = undo_.back().nats;
    undo_.pop_back();
  }
}

ViewTable::ViewTable(const models::OccupancyBelief& belief, const models::BeamSensor& sensor,
                     const ViewOptions& options)
    : belief_(&belief),
      sensor_(sensor),
      options_(options),
      sectors_(is_full_circle(sensor) ? 1 : 4 * sensor.beams),
      within_(belief.geometry().size()) {
  models::require_valid(sensor);
  require(options.dependent_share > 0.0 && options.dependent_share <= 1.0,
          "dependent_share must be in (0, 1]");
  require(options.cutoff_sigmas > 0.0, "cutoff_sigmas must be > 0");
}

const BeamView& ViewTable::view(const Pose2& world_from_body) {
  static const BeamView kNothing;
  const int cell = belief_->geometry().index_of(world_from_body.position_m());
  if (cell < 0) {
    return kNothing;
  }
  const double sector_rad = 2.0 * kPi / sectors_;
  const std::int64_t sector =
      sectors_ == 1 ? 0 : std::lround(wrap_to_pi(world_from_body.yaw_rad) / sector_rad);
  const std::int64_t wrapped = (sector + sectors_) % sectors_;
  const auto [place, is_new] = views_.try_emplace(cell * std::int64_t{sectors_} + wrapped);
  if (is_new) {
    place->second =
        look(belief_->geometry().centre_m(cell), static_cast<double>(wrapped) * sector_rad);
  }
  return place->second;
}

BeamView ViewTable::look(const Eigen::Vector2d& from_m, double yaw_rad) {
  BeamView all;
  for (int beam = 0; beam < sensor_.beams; ++beam) {
    models::trace_beam(*belief_, sensor_, from_m, yaw_rad + sensor_.bearing_rad(beam), profile_);
    beam_cells_ += profile_.size();
    double reach = 1.0;
    double weights = 0.0;
    weight_.clear();
    for (const double o : profile_.occupancy) {
      weight_.push_back(reach * o * (1.0 - o));
      weights += weight_.back();
      reach *= 1.0 - o;
    }
    if (weights <= 0.0) {
      continue;  // all cells of the beam are known
    }
    const double nats =
        options_.measure == BeamMeasure::kCsqmi
            ? models::csqmi(profile_, sensor_, options_.cutoff_sigmas).nats
            : models::fsmi(profile_, sensor_, options_.inverse, options_.cutoff_sigmas).nats;
    const auto begin = static_cast<std::uint32_t>(all.shares.size());
    for (std::size_t k = 0; k < weight_.size(); ++k) {
      if (weight_[k] > 0.0) {
        all.shares.push_back({profile_.cell[k], nats * weight_[k] / weights});
      }
    }
    all.beams.push_back({nats, begin, static_cast<std::uint32_t>(all.shares.size())});
  }
  if (options_.dependence == BeamDependence::kBestOfCell) {
    return merged(all);
  }
  BeamView kept;
  for (const BeamView::Beam& beam : all.beams) {
    const BeamView one{beam.nats,
                       {{beam.nats, 0, beam.end - beam.begin}},
                       {all.shares.begin() + beam.begin, all.shares.begin() + beam.end}};
    if (within_.add(one, options_) > 0.0) {
      const auto begin = static_cast<std::uint32_t>(kept.shares.size());
      kept.shares.insert(kept.shares.end(), one.shares.begin(), one.shares.end());
      kept.beams.push_back({beam.nats, begin, static_cast<std::uint32_t>(kept.shares.size())});
      kept.nats += beam.nats;
    }
  }
  within_.undo_to(0);
  return kept;
}

}  // namespace vantage::planner
