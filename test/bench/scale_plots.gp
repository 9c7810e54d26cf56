# gnuplot -e "in='build/scale'; out='docs/images'" test/bench/scale_plots.gp
# needs <in>/cost.csv and <in>/traffic.csv of test/rig/scale.sh
set terminal pngcairo size 1300,450 font "Sans,12"
set output out."/scale.png"
set datafile separator ","
set grid lc rgb "#dddddd"
set logscale x
set xlabel "robots, and as many targets"
set xtics (3, 10, 30, 100, 300, 1000)
set key top left samplen 2
set multiplot layout 1,3
set title "CPU time of a robot in a round"; set ylabel "ms"; set yrange [0:*]
plot in."/cost.csv" every ::1 using 1:8 with linespoints pt 7 lw 2 lc rgb "#0072B2" notitle
set title "memory of the process"; set ylabel "MB"; set logscale y; set yrange [10:*]
plot in."/cost.csv" every ::1 using 1:7 with linespoints pt 7 lw 2 lc rgb "#D55E00" notitle
set key right center
set title "what a robot says in a second"; set ylabel "bytes"; unset logscale y; set yrange [0:*]
of(kind) = sprintf("< grep ',%s,' %s/traffic.csv", kind, in)
plot for [i=1:4] of(word("BELIEF PLAN MEASUREMENT QUADROTOR", i)) using 1:3 with linespoints pt 7 lw 2 lc i title word("BELIEF PLAN MEASUREMENT QUADROTOR", i)
unset multiplot
