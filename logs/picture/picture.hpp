#pragma once

#include <string>

#include "core/result.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "logs/picture/panel.hpp"
#include "logs/picture/scene.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// Returns a picture of the end of a trial as SVG text: world, obstacles, explored ground, robot
/// tracks, fields of view, plans, true targets, estimates with 95 % ellipses, jammed robots, the
/// map of a mapping team, key numbers and legend. Equal inputs give equal bytes.
std::string draw_picture(const scenario::Scenario& scenario, const Scene& scene,
                         const logs::TrialSummary& summary,
                         KeyNumbers numbers = KeyNumbers::kTrial);

/// Renders an SVG file as PNG with rsvg-convert. Returns an Error if that program is not installed.
/// @throws std::runtime_error with file and reason if rendering or writing failed; `png_path` is
/// then unchanged.
Result<std::string> render_png(const std::string& svg_path, const std::string& png_path);

}  // namespace vantage::logs
