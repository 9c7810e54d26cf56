# gnuplot -e "in='build/planner_study.csv'; out='docs/images'" test/bench/search_plots.gp
set terminal pngcairo size 1500,860 font "Sans,12"
set datafile separator ","
set logscale x; set xlabel "CPU time [s]"; set grid lc rgb "#dddddd"
set key bottom left samplen 2
set xrange [0.0007:0.15]
keep(m, n, v) = (strcol(2) eq m && column(1) == n && column(5) == 0) ? v : 1/0
colour(m) = m eq "beam" ? "#0072B2" : m eq "arvi" ? "#D55E00" : m eq "rvi" ? "#009E73" : "#7f7f7f"
title_of(n) = n == 0 ? "all" : sprintf("M = %d", n)

set output out."/search_cost_vs_time.png"
set ylabel "mean excess over the best known cost [nats]"
set logscale y; set yrange [0.05:400]
set multiplot layout 2,3
do for [n in "1 3 9 16 25 0"] {
  set title title_of(n + 0)
  plot for [m in "beam arvi rvi greedy"] in using 3:(keep(m, n + 0, $7)) with linespoints pt 7 lw 2 lc rgb colour(m) title m
}
unset multiplot

set output out."/search_gap_vs_time.png"
set ylabel "mean gap: cost less proven bound [nats]"
unset logscale y; set yrange [0:*]
set multiplot layout 2,3
do for [n in "1 3 9 16 25 0"] {
  set title title_of(n + 0)
  plot for [m in "beam arvi rvi greedy"] in using 3:(keep(m, n + 0, $11)) with linespoints pt 7 lw 2 lc rgb colour(m) title m
}
unset multiplot
