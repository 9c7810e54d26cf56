# gnuplot -e "in='build/air'; out='docs/images'" test/bench/air_plots.gp
# needs <in>/air.csv of test/rig/air.sh
set terminal pngcairo size 1300,420 font "Sans,12"
set output out."/air.png"
set datafile separator ","
set grid lc rgb "#dddddd"
set logscale x
set xlabel "kbit/s per robot"
set xtics (8, 16, 33, 64, 128)
set xrange [7:75]
set key top right samplen 2
set multiplot layout 1,3
mean(kind, robots, column) = sprintf("< awk -F, '$1==\"%s\" && $2==%d {s[$4]+=$%d; n[$4]++} END {for (k in s) print k \",\" s[k]/n[k]}' %s/air.csv | sort -n", kind, robots, column, in)
do for [robots in "3 10 30"] {
  set title robots." robots, loss 20 %"
  set ylabel "RMSE per robot [m]"; set yrange [0:*]
  stats mean("unlimited", int(robots), 5) using 2 nooutput name "U"
  plot mean("budget", int(robots), 5) using 1:2 with linespoints pt 7 lw 2 lc rgb "#0072B2" title "budget", \
       mean("links", int(robots), 5) using 1:2 with linespoints pt 5 lw 2 lc rgb "#D55E00" title "links of this rate, no budget", \
       U_mean with lines dt 2 lc rgb "#333333" title "unlimited network"
}
unset multiplot
