#pragma once

#include <string>

#include "core/result.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "logs/picture/scene.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// A picture of the end of a trial as SVG text: world, obstacles, explored ground, driven tracks,
/// fields of view, plans, true targets and estimates with ellipses that hold 95 %, who is jammed,
/// the map of a team that maps; key numbers and legend. Pure: equal inputs give equal bytes.
std::string draw_picture(const scenario::Scenario& scenario, const Scene& scene,
                         const logs::TrialSummary& summary);

/// Renders an SVG file as PNG with rsvg-convert; the Error says what is missing.
/// @throws std::runtime_error with file and reason when it could not be written, or not be drawn;
///         `png_path` is then as before.
Result<std::string> render_png(const std::string& svg_path, const std::string& png_path);

}  // namespace vantage::logs
