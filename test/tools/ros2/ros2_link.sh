#!/bin/sh
# ros2_link.sh VANTAGE READER CONFIG_DIR: checks that `vantage ros2` and a DDS program that does not
# share its code exchange messages in a network namespace (in_network.sh). Prints one line per topic.
set -eu
vantage=$1 reader=$2 config=$3
folder=$(mktemp -d)
trap 'kill "$bridge" 2>/dev/null; wait "$bridge" 2>/dev/null; rm -rf "$folder"' EXIT
# The detector replaces the sensor of each robot.
sed 's/^  sensor: .*/  sensor:\n    device: external/' "$config/lab.yaml" >"$folder/lab.yaml"
cat >>"$folder/lab.yaml" <<END
ros2:
  detections:
    - {topic: /Q1/detections, robot: Q1}
END
"$vantage" ros2 "$folder/lab.yaml" >"$folder/out" 2>&1 &
bridge=$!
export CYCLONEDDS_URI='<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo"/></Interfaces></General></Domain></CycloneDDS>'
if ! "$reader" "$folder/lab.yaml"; then
  cat "$folder/out"
  exit 1
fi
grep -q '^ros2     domain 0 on network card lo: only programs on this host' "$folder/out"
