#!/bin/bash
# forged.sh BIN_DIR SCENARIO LCMTYPES: flies SCENARIO (devices on the wire) while an attacker without a key
# forges VICON, PLAN_* and COMMAND with the live streams' own run ids and numbers. If signatures are
# required, the forgeries have no effect, and the replay of the log is identical bit for bit. Without
# signatures, the forgeries disturb the flight. Runs in its own network.
. "$(dirname "$0")/up_support.sh"
types=$3 here=$(dirname "$0")
lcm-gen --python --ppath "$dir/py" "$types"/*.lcm
"$bin/vantage" keys new "$dir/keys"

# fly NAME SCENARIO: runs a flight that ends after the forgery; its log is $dir/NAME.lcmlog. If an
# overloaded machine made a vehicle land before the forgery, the flight is repeated, at most twice.
fly() {
  local status forged
  for _ in 1 2 3; do
    status=0 forged=0
    rm -f "$dir/$1.lcmlog"
    "$bin/vantage" up "$2" --fly --ignore-load --url "$url" --log "$dir/$1.lcmlog" --json \
      > "$dir/$1.json" 2> "$dir/$1.err" & up=$!
    python3 "$here/forge_live.py" "$dir/py" "$dir/$1.span" || forged=$?
    kill -INT "$up"
    wait "$up" || status=$?
    cat "$dir/$1.json"; echo
    if [[ $forged == 0 ]]; then
      [[ $status == 0 ]] || is_machine_overload "$1"
      return
    fi
    [[ $forged == 3 ]] && "$bin/hil_check" --held-up "$dir/$1.lcmlog" || break
    echo "forged.sh: $1 did not take off because the machine was overloaded; repeating it"
  done
  fail "no message was forged in $1"
}

{ cat "$scenario"; echo "security: {mode: require, keys: $dir/keys}"; } > "$dir/signed.yaml"
fly signed "$dir/signed.yaml" || fail "the signed flight failed"
"$bin/hil_check" --collisions "$dir/signed.lcmlog" || fail "collision in the signed flight"
options=(--signed)
"$bin/hil_check" --held-up "$dir/signed.lcmlog" && options+=(--held-up)
python3 "$here/forged_check.py" "$dir/py" "$dir/signed.lcmlog" "$dir/signed.span" "${options[@]}" ||
  fail "forged messages changed the signed flight"
! grep -qr "$(od -An -tx1 -v "$dir"/keys/mocap-*.key | tr -d ' \n')" "$dir"/*.json "$dir"/*.err ||
  fail "a key is printed"
python3 - "$dir" <<'PY' || fail "a key is in the log"
import glob, sys
log = open(sys.argv[1] + "/signed.lcmlog", "rb").read()
sys.exit(any(open(key, "rb").read()[:32] in log for key in glob.glob(sys.argv[1] + "/keys/*")))
PY
"$bin/vantage" log replay "$dir/signed.lcmlog" --node planner:Q2 --node estimator:Q2
"$bin/vantage" log metrics "$dir/signed.lcmlog" > /dev/null

fly open "$scenario" || true
! python3 "$here/forged_check.py" "$dir/py" "$dir/open.lcmlog" "$dir/open.span" ||
  fail "forged messages have no effect even without signatures: the test is void"
