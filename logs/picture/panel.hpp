#pragma once

#include "logs/metrics/trial_summary.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/scene.hpp"
#include "logs/picture/svg.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// Summary figures that a picture's header shows.
enum class KeyNumbers {
  kTrial,     ///< discovery, estimates, safety and punctuality
  kEstimate,  ///< present estimates only, for a task without planning rounds and collisions
};

/// Draws the title line and the key numbers above the map.
void draw_header(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const logs::TrialSummary& summary, KeyNumbers numbers);
/// Returns the height of draw_panel() in pixels.
double panel_height_px(const scenario::Scenario& scenario);
/// Draws a table and the legend next to the map. The table lists the targets or the robots' maps.
void draw_panel(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                const Scene& scene, const logs::TrialSummary& summary);

}  // namespace vantage::logs
