# Sourced first by tests of `vantage up` with the arguments BIN_DIR SCENARIO …. Sets $bin, $scenario, $url
# (a bus on this machine only) and $dir, a temporary folder. At the end, removes the folder and ends all
# processes that the test started.
set -euo pipefail
bin=$1 scenario=$2
url='udpm://239.255.76.67:7667?ttl=0'
dir=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; wait; rm -rf "$dir"' EXIT

fail() {
  echo "$(basename "$0"): $1" >&2
  cat "$dir"/*.err >&2
  exit 1
}

# until_true SECONDS COMMAND…: repeats COMMAND until it succeeds, for at most SECONDS.
until_true() {
  local tries=$(($1 * 10))
  shift
  while ! "$@"; do
    ((tries-- > 0)) || return 1
    sleep 0.1
  done
}

# Prints the child of process $1 with a command line that matches $2; nothing if there is none.
child_of() { pgrep -P "$1" -f "$2" || true; }

# Prints the number of events of each PLAN_ channel in log $1: "Q1 12 Q2 12 Q3 11".
plans_in() {
  "$bin/vantage" log info "$1" --json | python3 -c '
import json, sys
channels = json.load(sys.stdin)["channels"]
counts = {name: c["events"] for name, c in channels.items() if name.startswith("PLAN_")}
print(" ".join(f"{name[5:]} {count}" for name, count in sorted(counts.items())))'
}

# True if log $1 has at least two more plans of each of the robots $3… than the counts $2.
plans_go_on() {
  local log=$1 before=" $2 " now robot was is
  now=" $(plans_in "$log") "
  for robot in "${@:3}"; do
    was=0
    [[ $before =~ " $robot "([0-9]+) ]] && was=${BASH_REMATCH[1]}
    [[ $now =~ " $robot "([0-9]+) ]] || return 1
    is=${BASH_REMATCH[1]}
    ((is >= was + 2)) || return 1
  done
}

# True if `vantage up` (files $dir/$1.json, .err and .lcmlog) reports nothing except effects of an
# overloaded machine: a log that was late but is complete, or collisions that are therefore not judged.
is_machine_overload() {
  local remarks
  remarks=$(grep '^vantage: ' "$dir/$1.err" || true)
  case $remarks in
    'vantage: log: could not be written for some time') ;;
    '') grep -q '"collisions":[1-9]' "$dir/$1.json" || return 1 ;;
    *) return 1 ;;
  esac
  "$bin/hil_check" --held-up "$dir/$1.lcmlog" && "$bin/hil_check" --collisions "$dir/$1.lcmlog"
}

# Starts an independent logger of the plans, the witness, which is never killed.
start_witness() {
  lcm-logger --quiet --force --channel='PLAN_.*' --lcm-url="$url" "$dir/witness.lcmlog" &
  witness=$!
  until_true 10 test -e "$dir/witness.lcmlog" || fail "no witness"
}
