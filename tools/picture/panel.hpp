#pragma once

#include "logs/metrics/trial_summary.hpp"
#include "models/scenario/scenario.hpp"
#include "tools/picture/layout.hpp"
#include "tools/picture/scene.hpp"
#include "tools/picture/svg.hpp"

namespace vantage::tools {

/// Title line and key numbers above the map.
void draw_header(Svg& svg, const Layout& layout, const models::Scenario& scenario,
                 const logs::TrialSummary& summary);
/// How tall draw_panel() will be, in pixels.
double panel_height_px(const models::Scenario& scenario);
/// Table of targets, or of what each robot mapped, and legend beside the map.
void draw_panel(Svg& svg, const Layout& layout, const models::Scenario& scenario,
                const Scene& scene, const logs::TrialSummary& summary);

}  // namespace vantage::tools
