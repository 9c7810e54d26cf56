#include "tools/experiment/figures.hpp"

namespace vantage::tools {
namespace {

// Draws draw_all() as `name`.svg and `name`.png; the script says how large and what.
std::string figure(const std::string& name, const std::string& size, const std::string& plots) {
  // Lines are not drawn across what a filter within gnuplot leaves out: awk picks the rows.
  return "rows(m) = sprintf(\"< awk -F, '$2 == \\\"%s\\\"' summary.csv\", m)\n"
         "set datafile separator ','\nset grid lc rgb '#dddddd'\n"
         "set style fill transparent solid 0.15 noborder\n"
         "do for [kind in 'svg png'] {\n"
         "  if (kind eq 'svg') { set terminal svg size " +
         size + " font 'Sans,12' background 'white' } else { set terminal pngcairo size " + size +
         " font 'Sans,12' }\n  set output '" + name + ".'.kind\n" + plots +
         "  unset multiplot\n  set output\n}\n";
}

}  // namespace

std::string dls_savings_figure() {
  return figure("dls-savings", "1100,430", R"gp(
  colour(m) = m eq 'naive' ? '#0072B2' : m eq 'lazy' ? '#E69F00' : m eq 'warm' ? '#CC79A7' : '#009E73'
  set multiplot layout 1,2
  set key top left samplen 2
  set xlabel 'robots'; set xrange [1.8:10.2]
  set ylabel 'oracle calls / N'; set logscale y; set yrange [0.7:100]
  plot for [m in '"naive" "lazy" "warm" "lazy + warm"'] rows(m) using 1:7 with linespoints pt 7 lw 2 lc rgb colour(m) title m
  unset logscale y; set ylabel 'proposals adopted'; set yrange [0:*]
  plot for [m in '"naive" "lazy" "warm" "lazy + warm"'] rows(m) using 1:9 with linespoints pt 7 lw 2 lc rgb colour(m) title m
)gp");
}

std::string dls_objective_figure() {
  return figure("dls-objective", "760,520", R"gp(
  colour(m) = m eq 'dls' ? '#009E73' : m eq 'dls best 10 %' ? '#0072B2' : m eq 'cd cheap first' ? '#8B5A2B' : '#E69F00'
  set multiplot layout 1,1
  set key top left samplen 2
  set xlabel 'robots'; set xrange [1.8:10.2]
  set ylabel 'J = I - C  [nats], mean and its 95 % interval'; set yrange [0:*]
  plot for [m in '"cd dear first" "cd cheap first" "dls"'] rows(m) using 1:($4 - $6):($4 + $6) with filledcurves lc rgb colour(m) notitle, \
       for [m in '"cd dear first" "cd cheap first" "dls"'] rows(m) using 1:4 with linespoints pt 7 ps 0.6 lw 2 lc rgb colour(m) title m, \
       rows('dls best 10 %') using 1:4 with points pt 2 ps 1.3 lw 2 lc rgb colour('dls best 10 %') title 'dls best 10 %'
)gp");
}

std::string resilient_tracking_figure() {
  return figure("resilient-tracking", "1100,760", R"gp(
  steps(a, m) = sprintf("< awk -F, '$3 == %s && $4 == \"%s\"' steps.csv", a, m)
  colour(m) = m eq 'rain' ? '#009E73' : '#D55E00'
  set multiplot layout 2,2
  set key top left samplen 2
  set xlabel 'time [s]'
  do for [a in '2 6'] {
    set title '10 robots, 10 targets, '.a.' attacks'
    set ylabel 'mean entropy per target [nats]'
    plot for [m in '"cd" "rain"'] steps(a, m) using (0.5 * $5):7 with lines lw 2 lc rgb colour(m) title m
    set ylabel 'mean RMSE [m]'
    plot for [m in '"cd" "rain"'] steps(a, m) using (0.5 * $5):6 with lines lw 2 lc rgb colour(m) title m
  }
)gp");
}

}  // namespace vantage::tools
