#include "tools/log/motion_plot.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/support/temporary_folder.hpp"
#include "tools/log/log_plot.hpp"

namespace vantage::tools {
namespace {

std::vector<logs::FittedMotion> two_fits() {
  std::vector<logs::FittedMotion> fits(2);
  fits[0].model.kind = models::TargetKind::kRandomWalk;
  fits[1].model.kind = models::TargetKind::kDampedOscillator;
  for (logs::FittedMotion& fit : fits) {
    for (auto& of_coordinate : fit.held_back.displacements) {
      for (std::size_t h = 0; h < logs::kHorizons_s.size(); ++h) {
        const double lag_s = logs::kHorizons_s[h];
        of_coordinate[h] = {lag_s * lag_s, 4.0 * lag_s * lag_s};
      }
    }
  }
  return fits;
}

TEST(MotionPlot, ShowsRootMeanSquareDisplacementByLag) {
  const std::string script = motion_plot_script(two_fits(), "title", "motion.svg");
  EXPECT_NE(script.find("\n0.5 0.5 1 1\n"), std::string::npos) << script;
  EXPECT_NE(script.find("\n8 8 16 16\n"), std::string::npos) << script;
  EXPECT_THROW(static_cast<void>(motion_plot_script(two_fits(), "title", "motion.docx")),
               StartupError);
}

TEST(MotionPlot, IsDrawnByGnuplotWithTheModelsNames) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "gnuplot is not installed";
  }
  const test::TemporaryFolder folder;
  const std::string svg = folder.file("it's a plot.svg");
  const auto drawn =
      draw_plot(motion_plot_script(two_fits(), "a 'title'", svg), folder.file("p.gp"), svg);
  ASSERT_TRUE(drawn.ok()) << drawn.error().message;
  std::ifstream in(svg);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  for (const char* name :
       {"measured", "random_walk", "damped_oscillator", "RMS displacement in y, m"}) {
    EXPECT_NE(text.find(name), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace vantage::tools
