#!/bin/sh
# viewer.sh channels|page log|live|late|sessions|operate|access|proposals|foreign|record VANTAGE SOURCE_DIR: tests `vantage
# view` on the sample log, on a log of a team that plans by local search or on a log of another robot, and
# tests `vantage demo --view`. The client is Foxglove's own client (channels) or headless Chromium (page).
# Screenshots go to $VANTAGE_SHOTS if it is set. Exit code 77: a requirement is missing.
what=$1
kind=$2
vantage=$3
source=$4
peer=$source/test/view/peer

is_log=

skip() {
  echo "skipped: $1"
  exit 77
}
[ -d "$peer/node_modules/ws" ] || skip "npm has not fetched the clients (tools/setup)"
if [ "$what" = page ]; then
  command -v "${CHROMIUM:-chromium}" >/dev/null || skip "no chromium"
fi

folder=$(mktemp -d)
server=
trap 'kill "$server" 2>/dev/null; wait "$server" 2>/dev/null; rm -rf "$folder"' EXIT
case $kind in log | access | record) is_log=yes ;; esac
if [ "$is_log" ]; then
  xz -dkc "$source/logs/sample/lab_60s.lcmlog.xz" >"$folder/lab.lcmlog" || skip "no xz"
  "$vantage" view "$folder/lab.lcmlog" --port 0 >"$folder/out" 2>&1 &
elif [ "$kind" = foreign ]; then
  "$source/test/view/foreign_log.py" "$folder" || exit 1
  "$vantage" view "$folder/foreign.lcmlog" --types "$folder/types" --port 0 >"$folder/out" 2>&1 &
elif [ "$kind" = sessions ]; then
  export BUS='udpm://239.255.76.67:7667?ttl=0' VANTAGE="$vantage" SCENARIO="$source/config/lab.yaml"
  "$vantage" view --url "$BUS" --port 0 >"$folder/out" 2>&1 &
elif [ "$kind" = operate ]; then
  export BUS='udpm://239.255.76.67:7667?ttl=0' VANTAGE="$vantage" SCENARIO="$source/config/lab-hil.yaml"
  "$vantage" view --operate --url "$BUS" --port 0 >"$folder/out" 2>&1 &
elif [ "$kind" = proposals ]; then
  "$vantage" trial "$source/config/lab-energy.yaml" --duration-s 8 --log "$folder/lab.lcmlog" \
    >"$folder/trial.out" 2>&1 || { cat "$folder/trial.out"; exit 1; }
  "$vantage" view "$folder/lab.lcmlog" --port 0 >"$folder/out" 2>&1 &
else
  "$vantage" demo --scenario "$source/config/lab.yaml" --duration-s 600 --out "$folder" \
    --view --port 0 >"$folder/out" 2>&1 &
fi
server=$!
tries=0
until url=$(grep -o -m 1 'http://[0-9.:]*' "$folder/out"); do
  tries=$((tries + 1))
  if [ $tries -gt 300 ] || ! kill -0 $server 2>/dev/null; then
    cat "$folder/out"
    exit 1
  fi
  sleep 0.1
done

case $what in
  channels) node "$peer/channels.mjs" "ws${url#http}" 30 ;;
  page)
    if grep -q 'not built' "$folder/out"; then
      skip "the page was not built"
    fi
    script=page
    KEY=$(sed -n 's/.*#operate=\([0-9a-f]*\).*/\1/p' "$folder/out")
    export KEY
    [ -f "$peer/$kind.mjs" ] && script=$kind
    if [ "$kind" = record ]; then
      "$vantage" view "$folder/lab.lcmlog" --record "$folder/lab.webm" --from-s 20 --to-s 22 --fps 10 \
        --width 640 --height 480 || exit 1
      set -- "$folder/lab.webm"
    else
      set --
    fi
    node "$peer/$script.mjs" "$url" "$kind" "$@" "${VANTAGE_SHOTS:-}"
    ;;
esac
