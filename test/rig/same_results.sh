#!/bin/bash
# same_results.sh [--quick] [OTHER [BIN]]: checks that two builds decide alike to the last bit. OTHER and
# BIN are the folders of their programs: build/arm64/bin and build/release/bin by default. Programs for arm64
# run under qemu's user mode (tools/setup --arm64).
#   1. Each build flies the same trial in virtual time: the logs have the same bytes.
#   2. Each build repeats every plan and belief of the other's log, and of the sample log.
#   3. Each build flies a trial in real time with one process per node (`vantage up`, in a separate
#      network namespace); the other repeats it.
#   4. OTHER equals test/guard/table.json.
# --quick leaves out 3 and 4, which take long under qemu. Prints a line for each comparison. Exit code
# 1: a difference; 2: a build is missing or cannot run here.
set -euo pipefail
cd "$(dirname "$0")/../.."
quick=no
if [[ "${1:-}" == --quick ]]; then
  quick=yes
  shift
fi
other=${1:-build/arm64/bin} bin=${2:-build/release/bin}
for folder in "$other" "$bin"; do
  cache=$(sed -n 's/^VANTAGE_ARM64_ROOT:PATH=//p' "$folder/../CMakeCache.txt" 2>/dev/null || true)
  [[ -z "$cache" ]] || export QEMU_LD_PREFIX=$cache  # libraries of emulated programs
  if ! "$folder/vantage" --version >/dev/null 2>&1; then
    echo "same_results: $folder/vantage does not run here: build it (docs/start/install.md), and for" \
      "another processor run tools/setup --arm64" >&2
    exit 2
  fi
done
# A log contains the version of the program that wrote it.
if [[ "$("$other/vantage" --version)" != "$("$bin/vantage" --version)" ]]; then
  echo "same_results: $other and $bin are builds of different commits: build both from one commit" >&2
  exit 2
fi
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
status=0
# compare TITLE COMMAND…: prints whether COMMAND found no difference.
compare() {
  local title=$1 words
  shift
  if words=$("$@" 2>&1); then
    echo "same       $title"
  else
    echo "DIFFERENT  $title"
    printf '%s\n' "$words" | tail -20
    status=1
  fi
}

for scenario in lab lab-unlabelled mapping; do
  for build in other bin; do
    "${!build}/vantage" trial "config/$scenario.yaml" --seed 1 --duration-s 20 --nodes 2000 \
      --log "$dir/$scenario-$build.lcmlog" >/dev/null
  done
  compare "trial $scenario: bytes of the log" cmp "$dir/$scenario"-{other,bin}.lcmlog
done
compare "log of $other, replayed by $bin" "$bin/vantage" log replay "$dir/lab-other.lcmlog"
compare "log of $bin, replayed by $other" "$other/vantage" log replay "$dir/lab-bin.lcmlog"
compare "sample log, replayed by $other" \
  test/tools/sample_replays.sh "$other/vantage" logs/sample/lab_60s.lcmlog.xz
[[ "$quick" == no ]] || exit $status

for build in other bin; do
  # Exit code 1, for example because emulated processes are late, is ignored: only the log is used.
  test/integration/in_network.sh "$PWD/${!build}/vantage" up config/lab.yaml --duration-s 20 \
    --url 'udpm://239.255.76.67:7667?ttl=0' --json --log "$dir/flight-$build.lcmlog" \
    >"$dir/$build.txt" 2>&1 || (($? == 1)) || { cat "$dir/$build.txt" >&2; exit 2; }
done
compare "flight of $other, replayed by $bin" "$bin/vantage" log replay "$dir/flight-other.lcmlog"
compare "flight of $bin, replayed by $other" "$other/vantage" log replay "$dir/flight-bin.lcmlog"
compare "test/guard/table.json, by $other" test/guard/guard.py --bin "$other"
exit $status
