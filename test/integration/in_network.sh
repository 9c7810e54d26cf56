#!/bin/sh
# in_network.sh [--no-route] [--first] BINARY [ARGS…]: runs BINARY in its own network namespace, where lo is
# up and carries multicast (unless --no-route). --first: at a higher priority (nice) where this is
# permitted, as in a flight. Nothing reaches or survives outside. Exit code 77: not possible here.
route='ip route add 224.0.0.0/4 dev lo' first=
while :; do
  case $1 in
    --no-route) route=true ;;
    --first) [ "$(nice -n -10 nice 2>/dev/null)" -lt "$(nice)" ] && first='nice -n -10' ;;
    *) break ;;
  esac
  shift
done
if ! unshare -rn true 2>/dev/null; then
  echo "skipped: this system does not allow 'unshare -rn' (user and network namespaces)"
  exit 77
fi
exec $first unshare -rn sh -c "ip link set lo up && $route && exec \"\$0\" \"\$@\"" "$@"
