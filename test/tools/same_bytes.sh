#!/bin/bash
# same_bytes.sh SOURCE_DIR: checks that two libraries, built from copies of the sources in folders
# with names of different length, have the same bytes and contain no folder name of this machine.
set -euo pipefail
source=$1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
export CCACHE_DISABLE=1 SOURCE_DATE_EPOCH=1700000000

for place in one a/much/longer/other; do
  mkdir -p "$dir/$place"
  cp -r "$source"/{CMakeLists.txt,cmake,config,core,models,wire,scenario,packaging} "$dir/$place"
  cmake -S "$dir/$place" -B "$dir/$place/made" -G Ninja -DCMAKE_BUILD_TYPE=Release -DVANTAGE_COMPONENTS=wire \
    -DVANTAGE_HARDENED=ON -DVANTAGE_BUILD_TESTS=OFF > "$dir/log" 2>&1 || { cat "$dir/log"; exit 1; }
  cmake --build "$dir/$place/made" --target vantage_core vantage_rover_wire >> "$dir/log" 2>&1 || { cat "$dir/log"; exit 1; }
done
for library in core/libvantage_core.a wire/rover/libvantage_rover_wire.a; do
  cmp "$dir/one/made/$library" "$dir/a/much/longer/other/made/$library"
  if grep -aq "$dir" "$dir/one/made/$library"; then
    echo "$library contains its build folder"
    exit 1
  fi
done
