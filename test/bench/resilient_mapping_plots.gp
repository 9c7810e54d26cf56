# gnuplot -e "in='build/resilient_mapping'; out='docs/images'" test/bench/resilient_mapping_plots.gp
# wants <in>/<world>_worst_2* of resilient_mapping_study for both worlds
set terminal pngcairo size 1500,1020 font "Sans,12"
set output out."/resilient_mapping_maps.png"
set palette defined (0 "white", 0.5 "#b0b0b0", 1 "black"); set cbrange [0:1]; unset colorbox
set size ratio -1; set xrange [0:16]; set yrange [0:16]
set xlabel "x [m]"; set ylabel "y [m]"
set key outside bottom center horizontal
set multiplot layout 2,3
do for [world in "squares corridors"] {
  half = world eq "squares" ? 25 : 50
  do for [map in "truth half end"] {
    set title map eq "truth" ? world.": truth" : map eq "half" ? sprintf("RAIN, 2 of 6 attacked: after %d s", half) : sprintf("after %d s", 2*half)
    if (map eq "truth") {
      plot in."/".world."_truth.txt" matrix using (0.2*$1+0.1):(0.2*$2+0.1):3 with image notitle
    } else {
      until = map eq "half" ? half : 2*half
      since = map eq "half" ? 0 : half
      poses = in."/".world."_worst_2_rain_poses.txt"
      plot in."/".world."_worst_2_rain_".map.".txt" matrix using (0.2*$1+0.1):(0.2*$2+0.1):3 with image notitle, \
        for [i=0:5] poses index i using ($1 >= since && $1 <= until ? $2 : 1/0):3 with lines lw 1 lc rgb "#56B4E9" notitle, \
        for [i=0:5] poses index i using ($1 >= since && $1 <= until && $4 == 0 ? $2 : 1/0):3 with points pt 7 ps 0.5 lc rgb "#0072B2" title (i == 0 ? "saw" : ""), \
        for [i=0:5] poses index i using ($1 >= since && $1 <= until && $4 == 1 ? $2 : 1/0):3 with points pt 7 ps 0.5 lc rgb "#D55E00" title (i == 0 ? "attacked" : "")
    }
  }
}
unset multiplot

set terminal pngcairo size 1300,520 font "Sans,12"
set output out."/resilient_mapping_entropy.png"
set key inside top right vertical; set size noratio; set datafile separator ","
set xrange [0:*]; set yrange [0:*]
set xlabel "time [s]"; set ylabel "map entropy, mean of the trials [nats]"
set multiplot layout 1,2
do for [world in "squares corridors"] {
  set title world.", 2 of 6 robots attacked at a time"
  rows(attack, planner) = "< grep ^".planner.", ".in."/".world."_".attack."_2.csv"
  plot rows("worst", "descent") using 3:4 smooth unique with lines lw 2 lc rgb "#D55E00" title "coordinate descent, worst case", \
       rows("worst", "rain") using 3:4 smooth unique with lines lw 2 lc rgb "#0072B2" title "RAIN, worst case", \
       rows("random", "descent") using 3:4 smooth unique with lines lw 2 dt 2 lc rgb "#D55E00" title "coordinate descent, random", \
       rows("random", "rain") using 3:4 smooth unique with lines lw 2 dt 2 lc rgb "#0072B2" title "RAIN, random"
}
unset multiplot
