#pragma once

#include "logs/metrics/trial_summary.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/scene.hpp"
#include "logs/picture/svg.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// Title line and key numbers above the map.
void draw_header(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const logs::TrialSummary& summary);
/// How tall draw_panel() will be, in pixels.
double panel_height_px(const scenario::Scenario& scenario);
/// Table of targets, or of what each robot mapped, and legend beside the map.
void draw_panel(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                const Scene& scene, const logs::TrialSummary& summary);

}  // namespace vantage::logs
