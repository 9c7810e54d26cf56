# gnuplot -e "in='build/decision'; out='docs/images'" test/bench/decision_plots.gp
# needs <in>/decision_ratios.csv of decision_study
set terminal pngcairo size 1300,900 font "Sans,12"
set output out."/decision_ratios.png"
set grid lc rgb "#dddddd"
set key top left samplen 2
set xlabel "value / exhaustive optimum"; set ylabel "share of the instances at or below"
set yrange [0:0.12]
ratios(measure, method) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" { print $4 }' %s/decision_ratios.csv | sort -g | awk '{ r[NR] = $1 } END { for (i = 1; i <= NR; ++i) print r[i], i / NR }'", measure, method, in)
colour(i) = i == 1 ? "#0072B2" : i == 2 ? "#E69F00" : i == 3 ? "#CC79A7" : "#009E73"
name(measure) = measure eq "mutual" ? "mutual information" : "log det"
set multiplot layout 2,2
do for [measure in "mutual logdet"] {
  set title name(measure).", no attack"; set xrange [0.85:1]
  plot for [i=1:4] ratios(measure, word("greedy CD CLS DLS", i)) with steps lw 2 lc rgb colour(i) title word("greedy CD CLS DLS", i)
}
do for [measure in "mutual logdet"] {
  set title name(measure).", after the worst attack on 1 or 2 robots"; set xrange [0.3:1]
  plot for [i=1:2] ratios(measure, "RTP ".i) with steps lw 2 lc rgb "#009E73" dt i title sprintf("RTP, %d", i), \
       for [i=1:2] ratios(measure, "CD attacked ".i) with steps lw 2 lc rgb "#D55E00" dt i title sprintf("coordinate descent, %d", i)
}
unset multiplot
