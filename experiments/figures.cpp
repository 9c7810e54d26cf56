#include "experiments/figures.hpp"

#include <array>

#include <fmt/format.h>

namespace vantage::experiments {
namespace {

// Returns a script that draws `plots` as `name`.svg and `name`.png.
std::string figure(const std::string& name, const std::string& size, const std::string& plots) {
  // gnuplot breaks lines at rows that its own filters exclude, so awk selects the rows.
  return "reset\nrows(m) = sprintf(\"< awk -F, '$2 == \\\"%s\\\"' summary.csv\", m)\n"
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
  set key center right samplen 2
  set xlabel 'robots'; set xrange [1.8:10.2]
  set ylabel 'oracle calls / N'; set logscale y; set yrange [0.003:30]
  plot for [m in '"naive" "lazy" "warm" "lazy + warm"'] rows(m) using 1:7 with linespoints pt 7 lw 2 lc rgb colour(m) title m
  set key top left
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

std::string heterogeneous_figures(const models::World& world, const std::string& titles) {
  std::string regions;
  for (std::size_t i = 0; i < world.regions.size(); ++i) {
    const models::Rectangle& at = world.regions[i].footprint;
    regions += fmt::format(
        "  set object {0} rectangle from {2},{3} to {4},{5} behind fillcolor rgb '{6}' "
        "fillstyle transparent solid 0.25 noborder\n"
        "  set label {0} '{1}' at {7},{8} font ',13' textcolor rgb '{6}'\n",
        i + 1, world.regions[i].name, at.min_m.x(), at.min_m.y(), at.max_m.x(), at.max_m.y(),
        i == 0 ? "#8B5A2B" : "#56B4E9", at.max_m.x() - 14.0,
        i == 0 ? at.min_m.y() + 5.0 : at.max_m.y() - 5.0);
  }
  return figure("heterogeneous", "760,560", R"gp(
  colour(m) = m eq 'dls' ? '#009E73' : m eq 'cd uav first' ? '#E69F00' : '#8B5A2B'
  called(m) = m eq 'dls' ? 'DLS' : m eq 'cd uav first' ? 'CD, UAV first' : 'CD, UGVs first'
  set key bottom right; set xrange [0:*]; set yrange [0:*]
  set xlabel 'energy C / r, mean and its 95 % interval'; set ylabel 'information I  [nats], mean and its 95 % interval'
  plot for [m in '"cd ugvs first" "cd uav first" "dls"'] rows(m) using 7:5:8:6 with xyerrorbars pt 0 lw 0.7 lc rgb colour(m) notitle, \
       for [m in '"cd ugvs first" "cd uav first" "dls"'] rows(m) using 7:5 with linespoints pt 7 ps 0.7 lw 2 lc rgb colour(m) title called(m), \
       rows('dls') using 7:5:(int(100 * $1 + 0.5) % 10 == 0 ? 'r = '.strcol(1) : '') with labels right offset -0.8,0.8 font ',10' textcolor rgb colour('dls') notitle
)gp") + figure("heterogeneous-ways", "1500,600", regions + "  titles = '" + titles + R"gp('
  set datafile separator whitespace; unset grid
  set xrange [0:100]; set yrange [0:100]; set size ratio -1
  set xlabel 'x [m]'; set ylabel 'y [m]'
  set key outside bottom center horizontal
  colour(robot) = word('#0072B2 #56259E #D55E00', robot + 1)
  set multiplot layout 1,3
  do for [k=0:2] {
    set title word(titles, k + 1)
    plot for [robot=0:2] 'ways.txt' index 3 * k + robot using 1:2 with linespoints pt 7 ps 0.4 lw 2 lc rgb colour(robot) title (robot == 2 ? 'UAV' : 'UGV '.(robot + 1)), \
         for [robot=0:2] '' index 3 * k + robot using 1:2 every ::0::0 with points pt 5 ps 1.6 lc rgb colour(robot) notitle, \
         'targets.txt' index k using 1:($3 > 0 ? $2 : 1/0) with points pt 3 ps 1.4 lw 2 lc rgb 'black' title 'target', \
         '' index k using 1:($3 == 0 ? $2 : 1/0) with points pt 6 ps 1.4 lw 1.5 lc rgb 'black' title 'never seen'
  }
)gp");
}

std::string resilient_tracking_figure() {
  return figure("resilient-tracking", "1100,760", R"gp(
  steps(a, m) = sprintf("< awk -F, '$3 == %s && $4 == \"%s\"' curves.csv", a, m)
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

std::string resilient_tracking_choices_figure() {
  return figure("resilient-tracking-choices", "1300,560", R"gp(
  of(r, m) = sprintf("< awk -F, '$4 == %s && $5 == %s && $7 == \"%s\"' table.csv", word(r, 1), word(r, 2), m)
  colour(m) = m eq 'rain' ? '#009E73' : '#D55E00'
  set multiplot layout 1,3
  set key top left samplen 2
  set xrange [-0.5:7.5]; set xtics rotate by -60 noenhanced
  set logscale y; set yrange [0.1:100]; set ylabel 'mean RMSE [m]'
  do for [r in '"5 10" "10 5" "10 10"'] {
    set title word(r, 1).' robots, '.word(r, 2).' targets'
    plot for [m in '"cd" "rain"'] of(r, m) using 0:9:xtic(strcol(1).', '.strcol(2).', '.strcol(3)) with points pt 7 ps 1.2 lc rgb colour(m) title m, \
         for [m in '"cd" "rain"'] of(r, m) using 0:11 with lines dt 2 lw 2 lc rgb colour(m) title m.', printed'
  }
)gp");
}

std::string resilient_mapping_figures() {
  return figure("resilient-mapping-maps", "1500,1020", R"gp(
  set datafile separator whitespace
  unset multiplot; set size; set xrange [*:*]; set yrange [*:*]
  stats "squares_ways.txt" using 1 nooutput; last_squares = int(STATS_max)
  stats "corridors_ways.txt" using 1 nooutput; last_corridors = int(STATS_max)
  set palette defined (0 "white", 0.5 "#b0b0b0", 1 "black"); set cbrange [0:1]; unset colorbox
  set size ratio -1; set xrange [0:16]; set yrange [0:16]
  set xlabel "x [m]"; set ylabel "y [m]"
  set key outside bottom center horizontal
  set multiplot layout 2,3
  do for [world in "squares corridors"] {
    last = world eq "squares" ? last_squares : last_corridors; half = last / 2
    do for [map in "truth half end"] {
      set title map eq "truth" ? world.": truth" : map eq "half" ? sprintf("RAIN, 2 of 6 attacked: after %d s", half) : sprintf("after %d s", last)
      if (map eq "truth") {
        plot world."_truth.txt" matrix using (0.2*$1+0.1):(0.2*$2+0.1):3 with image notitle
      } else {
        until = map eq "half" ? half : last
        since = map eq "half" ? 0 : half
        ways = world."_ways.txt"
        plot world."_".map.".txt" matrix using (0.2*$1+0.1):(0.2*$2+0.1):3 with image notitle, \
          for [i=0:5] ways index i using ($1 >= since && $1 <= until ? $2 : 1/0):3 with lines lw 1 lc rgb "#56B4E9" notitle, \
          for [i=0:5] ways index i using ($1 >= since && $1 <= until && $4 == 0 ? $2 : 1/0):3 with points pt 7 ps 0.5 lc rgb "#0072B2" title (i == 0 ? "not attacked" : ""), \
          for [i=0:5] ways index i using ($1 >= since && $1 <= until && $4 == 1 ? $2 : 1/0):3 with points pt 7 ps 0.5 lc rgb "#D55E00" title (i == 0 ? "attacked" : "")
      }
    }
  }
)gp") + figure("resilient-mapping-entropy", "1300,860", R"gp(
  curve(world, attack, planner) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" && $3 == 2 && $4 == \"plain\" && $5 == \"%s\"' curves.csv", world, attack, planner)
  colour(planner) = planner eq "rain" ? "#0072B2" : "#D55E00"
  called(planner) = planner eq "rain" ? "RAIN" : "coordinate descent"
  set key inside top right
  set xlabel "time [s]"; set ylabel "map entropy [nats], 95 % interval"
  set yrange [0:*]
  set multiplot layout 2,2
  do for [world in "squares corridors"] {
    do for [attack in "worst random"] {
      set title world.", 2 of 6 robots attacked at a time, ".attack
      plot for [p in "descent rain"] curve(world, attack, p) using 6:($7 - $8):($7 + $8) with filledcurves lc rgb colour(p) notitle, \
           for [p in "descent rain"] curve(world, attack, p) using 6:7 with lines lw 2 lc rgb colour(p) title called(p)
    }
  }
)gp");
}

namespace {

// Common parts of the figures of active mapping: the size of the world, and the obstacle boxes.
const char* const kMappingArea = R"gp(
  set xrange [0:10]; set yrange [0:10]; set size ratio -1
  set xlabel "x [m]"; set ylabel "y [m]"
  set datafile separator whitespace; set style fill solid
)gp";
const char* const kMappingBoxes = R"gp(
  set object 1 rectangle from 3.885,0.825 to 5.925,2.865 front fillcolor rgb "#8b939c" fillstyle solid noborder
  set object 2 rectangle from 3.885,3.885 to 5.925,5.925 front fillcolor rgb "#8b939c" fillstyle solid noborder
  set object 3 rectangle from 3.885,6.945 to 5.925,8.975 front fillcolor rgb "#8b939c" fillstyle solid noborder
)gp";

// Returns panels of the search trees tree_`kind`_NAME.txt of three planners side by side, coloured
// by depth. `titles` names the planners, `targets` lists the target positions.
std::string tree_panels(const std::string& kind, const std::string& names,
                        const std::string& titles, int depth, const std::string& targets) {
  return fmt::format(R"gp(
  set palette defined (1 "#c6dbef", {3} "#4292c6", {4} "#08306b")
  set cbrange [1:{4}]; set cblabel "depth"
  titles = '{2}'
  set multiplot layout 1,3
  do for [k=1:3] {{
    set title word(titles, k)
    plot "tree_{0}_".word("{1}", k).".txt" index 0 using 1:2:3 with lines lc palette lw 0.6 notitle, \
         "" index 1 using 1:2 with lines lc rgb "#D55E00" lw 3 notitle, \
         "{5}" with points pt 7 ps 1.3 lc rgb "#009E73" notitle
  }}
)gp",
                     kind, names, titles, depth / 2, depth, targets);
}

}  // namespace

std::string active_mapping_figures() {
  const std::string area = kMappingArea;
  return figure("active-mapping-heat-map", "900,820", area + kMappingBoxes + R"gp(
  set title "Least cost-to-go h(x, y) by Thm 6 over T = 12 steps [m²]"
  set palette defined (0 "#08306b", 0.5 "#6baed6", 1 "#ffffe0"); set cbrange [2:16]
  plot "heat_map.txt" matrix using (0.05*$1+0.025):(0.05*$2+0.025):3 with image notitle, \
       "landmarks.txt" with points pt 7 ps 1.4 lc rgb "#D55E00" title "landmarks"
)gp") +
         figure("active-mapping-trees", "1650,620",
                area + kMappingBoxes +
                    tree_panels("known", "astar arvi aegis",
                                R"gp("A*" "ARVI (its first nodes)" "AEGIS (ε = 1, δ = 0.1)")gp", 12,
                                "landmarks.txt")) +
         figure("active-mapping-moving", "1650,620",
                area + tree_panels("moving", "rvi astar aegis",
                                   R"gp("RVI (ε = 1, δ = 0.1)" "A*" "AEGIS (ε = 1, δ = 0.1)")gp", 6,
                                   "moving_target.txt")) +
         figure("active-mapping-paths", "900,560", R"gp(
  set title "Mean cost per path and step in the search tree: obstacle-free random starts, 0.1 s each"
  set xlabel "mean over the tree of g(n)/t(n) [m²]"; set ylabel "starts"
  set yrange [0:*]
  width = 0.05
  bin(x) = width*(floor(x/width)+0.5)
  set style fill solid 0.45 border; set boxwidth width
  paths(m) = sprintf("< awk -F, '$1 == \"free-0.1s\" && $2 == \"%s\" && $7 != \"inf\" {print $9}' plans.csv", m)
  plot paths("astar") using (bin($1)):(1.0) smooth frequency with boxes lc rgb "#0072B2" title "A*", \
       paths("arvi") using (bin($1)):(1.0) smooth frequency with boxes lc rgb "#D55E00" title "ARVI", \
       paths("aegis") using (bin($1)):(1.0) smooth frequency with points pt 5 ps 1.2 lc rgb "#009E73" title "AEGIS"
)gp");
}

std::string surveillance_figures() {
  return figure("surveillance-intervals", "1000,760", R"gp(
  by(m) = sprintf("< awk -F, '$1 == \"greedy\" && $3 == 2 && $4 == \"%s\"' summary.csv", m)
  colour(m) = m eq 'rain' ? '#009E73' : '#D55E00'
  called(m) = m eq 'rain' ? 'RAIN' : 'coordinate descent'
  set multiplot layout 2,2
  set key bottom left samplen 2
  set xlabel 'T_{REPLAN} [steps]'; set xrange [0.5:10.5]; set xtics 1
  set ylabel 'steps, mean of trials, 95 % interval'; set yrange [0:*]
  array what[4] = ['interval between two observations', 'interval with the waits at both ends', 'interval, averaged per landmark', 'time since the last observation']
  do for [k=1:4] {
    set title what[k]
    plot for [m in 'cd rain'] by(m) using 2:(column(4 + 2 * k)):(column(5 + 2 * k)) with yerrorlines pt 7 ps 0.6 lw 2 lc rgb colour(m) title called(m)
  }
)gp") + figure("surveillance-camp", "1500,640", R"gp(
  set datafile separator whitespace
  boxes(kind) = sprintf("< awk '$1 == \"%s\"' boxes.txt", kind)
  of(m, i) = sprintf("< awk '$1 == %d && $2 <= 100' ways_%s.txt", i, m)
  array hue[5] = ['#0072B2', '#009E73', '#CC79A7', '#E69F00', '#56B4E9']
  set multiplot layout 1,2
  set size ratio -1; set xrange [0:120]; set yrange [0:90]
  set xlabel "x [m]"; set ylabel "y [m]"; set key outside bottom center horizontal
  do for [m in "cd rain"] {
    set title (m eq "cd" ? "coordinate descent" : "RAIN").", 2 of 5 attacked, T_{REPLAN} = 5: the first 100 steps"
    plot boxes("building") using 2:3:2:4:3:5 with boxxyerror fs solid 0.5 noborder lc rgb "#888888" title "buildings", \
      boxes("tree") using 2:3:2:4:3:5 with boxxyerror fs solid 0.6 noborder lc rgb "#3a7d34" title "trees", \
      for [i=0:4] of(m, i) using 3:4 with lines lw 1.5 lc rgb hue[i + 1] title sprintf("robot %d", i + 1), \
      for [i=0:4] of(m, i) using 3:($5 == 1 ? $4 : 1/0) with points pt 7 ps 0.35 lc rgb "#D55E00" title (i == 0 ? "attacked" : ""), \
      "landmarks.txt" using 1:2 with points pt 2 ps 1.2 lw 2 lc rgb "black" title "landmarks"
  }
)gp");
}

std::string resilient_hardware_figure() {
  return figure("resilient-hardware", "1200,900", R"gp(
  set datafile separator whitespace
  of(m, i) = sprintf("< awk '$1 == %d' ways_first_%s.txt", i, m)
  called(m) = m eq "cd" ? "without resilience" : "RAIN"
  set multiplot layout 3,2
  do for [m in "cd rain"] {
    set title called(m).", robot 1 jammed"
    set size ratio -1; set xrange [-4:4]; set yrange [-2:2]; set xlabel "x [m]"; set ylabel "y [m]"
    set key outside bottom center horizontal; set object 1 circle at -2,0 size 1 fs empty border lc rgb "#009E73"; set object 2 circle at 2,0 size 1 fs empty border lc rgb "#009E73"
    plot of(m, 0) using 3:4 with lines lw 1.5 lc rgb "#D55E00" title "robot 1", of(m, 1) using 3:4 with lines lw 1.5 lc rgb "#0072B2" title "robot 2", \
      "+" using (-2):(0) every 1000 with points pt 7 ps 1.5 lc rgb "#009E73" title "targets", "+" using (2):(0) every 1000 with points pt 7 ps 1.5 lc rgb "#009E73" notitle
  }
  unset object 1; unset object 2
  set size noratio; set xrange [0:120]; set yrange [0:8]; set xlabel "time [s]"
  do for [i=0:1] { do for [m in "cd rain"] {
    set title called(m).sprintf(": robot %d%s", i + 1, i == 0 ? ", jammed" : "")
    set ylabel "distance [m]"; set key inside top right horizontal
    plot of(m, i) using (0.5 * $2):5 with lines lw 2 lc rgb "#0072B2" title "to the left target", of(m, i) using (0.5 * $2):6 with lines lw 2 lc rgb "#E69F00" title "to the right", \
      1 with lines dt 2 lc rgb "#666666" title "range"
  } }
)gp");
}

std::string team_figure(const std::string& name, const std::string& axis,
                        const std::string& columns) {
  const bool is_pair = columns.find(',') != std::string::npos;
  // The first columns are the index, the setting's columns and the number of trials; then follow
  // pairs of mean and interval.
  const std::string label = is_pair ? "strcol(2).', '.strcol(3)" : "strcol(2)";
  const int first = is_pair ? 5 : 4;
  // Draws no lines, because a line between two planners has no meaning.
  const std::string style = columns == "planner" ? "yerrorbars" : "yerrorlines";
  const auto panel = [&](int measure, const std::string& what) {
    return "  set ylabel '" + what +
           "'\n  plot 'summary.csv' using 1:" + std::to_string(first + 2 * measure) + ":" +
           std::to_string(first + 2 * measure + 1) + ":xtic(" + label + ") every ::1 with " +
           style + " lw 2 pt 7 lc rgb '#0072B2' notitle\n";
  };
  return figure(name, "1000,700",
                "  set multiplot layout 2,2\n  set offsets 0.3, 0.3, 0, 0\n  set xtics "
                "noenhanced font ',10'\n  set xlabel '" +
                    axis + "'\n" + panel(0, "RMSE per robot [m]") +
                    panel(1, "entropy per robot [nats]") +
                    panel(2, "discovery time per robot [s]") + panel(4, "RMSE of the team [m]"));
}

std::string tracking_clutter_figure(std::span<const char* const> methods) {
  constexpr std::array<const char*, 4> kColours = {"#0072B2", "#D55E00", "#E69F00", "#555555"};
  const auto panel = [&](int column, const std::string& what) {
    std::string out = "  set ylabel '" + what + "'\n  plot ";
    for (std::size_t i = 0; i < methods.size(); ++i) {
      // The points are shifted sideways so that the intervals do not overlap.
      out += fmt::format(
          "{}'summary.csv' every {}::{} using ($0 + {}):{}:{}{} with yerrorlines lw 2 pt 7 "
          "lc rgb '{}' title '{}'",
          i == 0 ? "" : ", ", methods.size(), i + 1, 0.12 * static_cast<double>(i), column,
          column + 1, i == 0 ? ":xtic(strcol(1).', '.strcol(2))" : "",
          kColours[i % kColours.size()], methods[i]);
    }
    return out + "\n";
  };
  return figure(
      "tracking-clutter", "1100,500",
      "  set multiplot layout 1,2\n  set offsets 0.3, 0.3, 0, 0\n"
      "  set key tmargin center horizontal noenhanced\n  set xtics rotate by -45\n"
      "  set yrange [0:*]\n  set xlabel 'false alarms per scan, detection probability'\n" +
          panel(5, "OSPA [m]") + panel(7, "swaps per minute"));
}

std::string search_or_sampling_figure() {
  constexpr std::array<const char*, 4> kMethods = {"beam", "arvi", "astar", "sampling_tree"};
  constexpr std::array<const char*, 4> kColours = {"#0072B2", "#555555", "#E69F00", "#D55E00"};
  std::string losses = "  set ylabel 'loss [%]'\n  plot ";
  for (std::size_t i = 0; i < kMethods.size(); ++i) {
    // The points are shifted sideways so that the intervals do not overlap.
    losses += fmt::format(
        "{}'summary.csv' every {}::{} using ($0 + {}):4:5{} with yerrorbars lw 2 pt 7 lc rgb '{}' "
        "title '{}'",
        i == 0 ? "" : ", ", kMethods.size(), i + 1, 0.12 * static_cast<double>(i),
        i == 0 ? ":xtic(1)" : "", kColours[i], kMethods[i]);
  }
  return figure(
      "search-or-sampling", "1200,500",
      "  unset logscale x\n  unset xlabel\n  set multiplot layout 1,2\n  set offsets 0.3, 0.3, 0, "
      "0\n"
      "  set key tmargin center horizontal noenhanced\n"
      "  set xtics rotate by -45 noenhanced\n  set yrange [0:*]\n" +
          losses +
          "\n  set offsets 0, 0, 0, 0\n  set key off\n  set yrange [*:*]\n  set xtics norotate\n"
          "  set logscale x\n  set xlabel 'horizon [s]'\n"
          "  set ylabel 'loss of sampling\\_tree minus loss of beam [%]'\n"
          "  plot 0 lc rgb '#999999', 'differences.csv' every ::1 using 2:4:1 with "
          "points pt 7 ps 0.5 lc variable\n");
}

}  // namespace vantage::experiments
