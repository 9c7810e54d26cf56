#!/bin/bash
# full_disk.sh BIN_DIR SCENARIO: tests that a disk with too little free space for the log is refused before
# take-off. When the disk fills up in flight, or the log is removed, this is reported immediately, and the
# flight continues. Runs in its own network as root: the disk is a small one in memory.
if [[ $1 != --mounted ]]; then
  unshare -m true 2> /dev/null || { echo "skipped: no mount namespace"; exit 77; }
  exec unshare -m "$0" --mounted "$@"
fi
shift
. "$(dirname "$0")/up_support.sh"
disk=$dir/disk
mkdir "$disk"
mount -t tmpfs -o size=48m none "$disk" || { echo "skipped: no tmpfs"; exit 77; }
trap 'kill $(jobs -p) 2>/dev/null || true; wait; umount -l "$disk"; rm -rf "$dir"' EXIT

status=0
"$bin/vantage" up "$scenario" --url "$url" --duration-s 300 --log "$disk/flight.lcmlog" \
  > "$dir/refused.out" 2> "$dir/refused.err" || status=$?
[[ $status == 2 ]] || fail "a trial without space for its log exits with $status instead of 2"
grep -q 'free on the disk of .*flight.lcmlog; a log of 360 s takes at most 108.0 MB' "$dir/refused.err" ||
  fail "free and needed space are not printed"
[[ -z $(ls "$disk") ]] || fail "files were created"

start_witness
"$bin/vantage" up "$scenario" --url "$url" --duration-s 90 --log "$disk/flight.lcmlog" --json > "$dir/up.json" 2> "$dir/up.err" & up=$!
until_true 30 plans_go_on "$dir/witness.lcmlog" "" Q1 Q2 Q3 || fail "no robot publishes plans"
dd if=/dev/zero of="$disk/else" bs=64k 2> /dev/null || true
until_true 20 grep -q 'LOG NOT WRITTEN' "$dir/up.err" || fail "no message reports that the log is not written"
plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 || fail "the flight does not continue"
rm "$disk/else"
until_true 30 grep -q 'log: written as usual, with' "$dir/up.err" || fail "writing the log does not resume"
# The log is moved away, a folder gets its name, and the recorder is killed. The vehicles' processes must
# not restart.
pids=$(pgrep -P "$up" | sort)
recorder=$(child_of "$up" 'log record')
mv "$disk/flight.lcmlog" "$disk/elsewhere.lcmlog"
mkdir "$disk/flight.lcmlog"
kill -9 "$recorder"
until_true 20 grep -q 'recorder ended (signal 9)' "$dir/up.err" || fail "the end of the recorder is not reported"
plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 || fail "the flight ends with its log"
for pid in $pids; do
  [[ $pid == "$recorder" ]] || kill -0 "$pid" || fail "process $pid ended with the log"
done
kill -INT "$up"
status=0
wait "$up" || status=$?
cat "$dir/up.err" "$dir/up.json"
[[ $status == 1 ]] || fail "an unrecorded flight exits with $status instead of 1"
grep -q 'could not be written for some time' "$dir/up.err" || fail "the final report does not state that the log was not written"
python3 - "$dir/up.json" << 'END' || fail "the JSON report describes the log wrongly"
import json, sys
log = json.load(open(sys.argv[1]))["log"]
assert not log["is_good"] and not log["is_to_the_end"] and log["was_unwritten"], log
END
