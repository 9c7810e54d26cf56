#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/check.hpp"
#include "logs/picture/svg.hpp"
#include "tools/compare/comparison.hpp"

namespace vantage::tools {
namespace {

using logs::Svg;

constexpr std::array kDrawn = {"RMSE of a robot, m", "entropy of a robot's beliefs, nat",
                               "targets found", "time until found, s"};
constexpr double kWidth_px = 760.0;
constexpr double kLeft_px = 170.0;
constexpr double kRight_px = 30.0;
constexpr double kTop_px = 44.0;
constexpr double kRow_px = 26.0;
constexpr double kHead_px = 26.0;  ///< height of a quantity's name above its rows
constexpr double kFoot_px = 34.0;  ///< height of the axis below the rows
constexpr int kTicks = 5;

/// Extent of the values of one quantity, over all groups.
struct Axis {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double x_px(double value) const {
    return kLeft_px + (value - low) / (high - low) * (kWidth_px - kLeft_px - kRight_px);
  }
};

/// Returns the extent of quantity `i` with a margin; nullopt if no trial has a value.
std::optional<Axis> axis_of(const std::vector<TrialGroup>& groups, std::size_t i) {
  Axis axis;
  for (const TrialGroup& group : groups) {
    for (const ComparedTrial& trial : group.trials) {
      if (trial.quantities[i].value) {
        axis.include(*trial.quantities[i].value);
      }
    }
    const experiments::Sample sample = sample_of(group, i);
    if (sample.size() > 1) {
      axis.include(sample.mean() - sample.half_interval());
      axis.include(sample.mean() + sample.half_interval());
    }
  }
  if (axis.high < axis.low) {
    return std::nullopt;
  }
  const double margin = axis.high > axis.low ? 0.05 * (axis.high - axis.low) : 0.5;
  axis.low -= margin;
  axis.high += margin;
  return axis;
}

void draw_group(Svg& svg, const TrialGroup& group, std::size_t i, const Axis& axis, double y_px) {
  svg.text({kLeft_px - 12.0, y_px + 4.0}, group.name, R"(text-anchor="end" fill="#222")");
  for (const ComparedTrial& trial : group.trials) {
    if (trial.quantities[i].value) {
      svg.circle({axis.x_px(*trial.quantities[i].value), y_px}, 3.5,
                 R"(fill="#3b7dd8" fill-opacity="0.35")");
    }
  }
  const experiments::Sample sample = sample_of(group, i);
  if (sample.size() == 0) {
    return;
  }
  const double half = sample.half_interval();
  svg.line({axis.x_px(sample.mean() - half), y_px}, {axis.x_px(sample.mean() + half), y_px},
           R"(stroke="#14417d" stroke-width="2")");
  svg.line({axis.x_px(sample.mean()), y_px - 7.0}, {axis.x_px(sample.mean()), y_px + 7.0},
           R"(stroke="#14417d" stroke-width="2.5")");
}

void draw_axis(Svg& svg, const Axis& axis, double y_px) {
  svg.line({kLeft_px, y_px}, {kWidth_px - kRight_px, y_px}, R"(stroke="#999")");
  for (int k = 0; k <= kTicks; ++k) {
    const double value = axis.low + (axis.high - axis.low) * k / kTicks;
    svg.line({axis.x_px(value), y_px}, {axis.x_px(value), y_px + 4.0}, R"(stroke="#999")");
    svg.text({axis.x_px(value), y_px + 17.0}, fmt::format("{:.3g}", value),
             R"(text-anchor="middle" font-size="11" fill="#555")");
  }
}

}  // namespace

std::string comparison_figure(const std::vector<TrialGroup>& groups, const std::string& title) {
  require(!groups.empty(), "comparison: needs a group of trials");
  const std::vector<ComparedValue>& names = groups.front().trials.front().quantities;
  const double panel_px = kHead_px + kRow_px * static_cast<double>(groups.size()) + kFoot_px;
  Svg svg(kWidth_px, kTop_px + panel_px * static_cast<double>(kDrawn.size()) + 24.0);
  svg.open_group(R"(font-family="sans-serif" font-size="13")");
  svg.rectangle({0.0, 0.0}, {kWidth_px, kTop_px + panel_px * kDrawn.size() + 24.0},
                R"(fill="#fff")");
  svg.text({20.0, 28.0}, title, R"(font-size="16" fill="#222")");
  double top_px = kTop_px;
  for (const char* drawn : kDrawn) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [&](const ComparedValue& each) { return each.name == drawn; });
    const auto i = static_cast<std::size_t>(found - names.begin());
    const std::optional<Axis> axis = found == names.end() ? std::nullopt : axis_of(groups, i);
    svg.text({20.0, top_px + 16.0}, drawn, R"(font-weight="bold" fill="#222")");
    double y_px = top_px + kHead_px + 0.5 * kRow_px;
    for (const TrialGroup& group : groups) {
      if (axis) {
        draw_group(svg, group, i, *axis, y_px);
      }
      y_px += kRow_px;
    }
    if (axis) {
      draw_axis(svg, *axis, y_px - 0.3 * kRow_px);
    }
    top_px += panel_px;
  }
  svg.text({20.0, top_px + 8.0}, "points: trials; bar: mean and its 95 % confidence interval",
           R"(font-size="11" fill="#555")");
  svg.close_group();
  return svg.str();
}

}  // namespace vantage::tools
