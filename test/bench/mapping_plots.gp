# gnuplot -e "in='build/mapping_study'; out='docs/images'" test/bench/mapping_plots.gp
set terminal pngcairo size 900,820 font "Sans,13"
boxes = "3.885,0.825,5.925,2.865 3.885,3.885,5.925,5.925 3.885,6.945,5.925,8.975"
do for [i=1:3] {
  b = word(boxes, i)
  x0 = b[1:5] + 0.0; y0 = b[7:11] + 0.0; x1 = b[13:17] + 0.0; y1 = b[19:23] + 0.0
  set object i rectangle from x0,y0 to x1,y1 front fillcolor rgb "#8b939c" fillstyle solid noborder
}
$landmarks << EOD
3.5 6.8
3.5 2.2
6.5 2.2
6.5 6.8
3.5 4.0
6.5 4.8
EOD
set xrange [0:10]; set yrange [0:10]; set size ratio -1
set xlabel "x [m]"; set ylabel "y [m]"

set output out."/mapping_heat_map.png"
set title "Least cost-to-go h(x, y) by Thm 6 over T = 12 steps [m²]"
set palette defined (0 "#08306b", 0.5 "#6baed6", 1 "#ffffe0")
plot in."/heat_map.txt" matrix using (0.05*$1+0.025):(0.05*$2+0.025):3 with image notitle, \
     $landmarks with points pt 7 ps 1.4 lc rgb "#D55E00" title "landmarks"

set terminal pngcairo size 1650,620 font "Sans,13"
set palette defined (1 "#c6dbef", 6 "#4292c6", 12 "#08306b")
set cbrange [1:12]; set cblabel "depth"
set output out."/mapping_trees.png"
set multiplot layout 1,3
do for [name in "astar arvi aegis"] {
  set title (name eq "astar" ? "A*" : name eq "arvi" ? "ARVI (first 60 000 nodes)" : "AEGIS (ε = 1, δ = 0.1)")
  plot in."/tree_".name.".txt" index 0 using 1:2:3 with lines lc palette lw 0.6 notitle, \
       "" index 1 using 1:2 with lines lc rgb "#D55E00" lw 3 notitle, \
       $landmarks with points pt 7 ps 1.3 lc rgb "#009E73" notitle
}
unset multiplot

unset object 1; unset object 2; unset object 3
set cbrange [1:6]
set xrange [0:10]; set yrange [0:10]
set output out."/tracking_trees.png"
set multiplot layout 1,3
do for [name in "rvi astar aegis"] {
  set title (name eq "rvi" ? "RVI (ε = 1, δ = 0.1)" : name eq "astar" ? "A*" : "AEGIS (ε = 1, δ = 0.1)")
  plot in."/tracking_".name.".txt" index 0 using 1:2:3 with lines lc palette lw 0.6 notitle, \
       "" index 1 using 1:2 with lines lc rgb "#D55E00" lw 3 notitle, \
       "+" using (6.5+0.1*$1*0):(6.0) every ::0::0 with points pt 7 ps 1.3 lc rgb "#009E73" notitle
}
unset multiplot

set terminal pngcairo size 900,560 font "Sans,13"
unset colorbox; set size noratio
set output out."/mapping_cost_per_path.png"
set title "Mean cost of a path of the search tree a step, 100 free starts, 0.1 s each"
set xlabel "mean over the tree of g(n)/t(n) [m²]"; set ylabel "starts"
set xrange [1.6:3.1]; set yrange [0:*]
width = 0.05
bin(x) = width*(floor(x/width)+0.5)
set style fill solid 0.45 border; set boxwidth width
set datafile separator ","
pick(m, v) = (strcol(5) eq m && column(6) == 0.1) ? bin(v) : 1/0
plot in."/starts.csv" using (pick("astar", $9)):(1.0) smooth frequency with boxes lc rgb "#0072B2" title "A*", \
     "" using (pick("arvi", $9)):(1.0) smooth frequency with boxes lc rgb "#D55E00" title "ARVI", \
     "" using (pick("aegis", $9)):(1.0) smooth frequency with points pt 5 ps 1.2 lc rgb "#009E73" title "AEGIS"
