#!/bin/sh
# in_network.sh [--no-route] [--first] [--root] BINARY [ARGS…]: runs BINARY in its own network
# namespace, where lo is up and carries multicast (unless --no-route). --first: at a higher priority
# (nice) where this is permitted, as in a flight. --root: without a user namespace, so that root's
# right to set real-time priorities is kept. No packet and no process leaves the namespace. Exit
# code 77: not possible here.
route='ip route add 224.0.0.0/4 dev lo' first= namespaces=-rn
while :; do
  case $1 in
    --no-route) route=true ;;
    --first) [ "$(nice -n -10 nice 2>/dev/null)" -lt "$(nice)" ] && first='nice -n -10' ;;
    --root) namespaces=-n ;;
    *) break ;;
  esac
  shift
done
if ! unshare $namespaces true 2>/dev/null; then
  echo "skipped: this system does not allow 'unshare $namespaces' (network namespaces)"
  exit 77
fi
exec $first unshare $namespaces sh -c "ip link set lo up && $route && exec \"\$0\" \"\$@\"" "$@"
