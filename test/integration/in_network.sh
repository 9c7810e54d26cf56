#!/bin/sh
# in_network.sh [--no-route] BINARY [ARGS…]: runs BINARY in a network of its own, where lo is up and
# carries multicast (unless --no-route). Nothing reaches or survives outside. Exit code 77: cannot.
route='ip route add 224.0.0.0/4 dev lo'
if [ "$1" = --no-route ]; then
  route=true
  shift
fi
if ! unshare -rn true 2>/dev/null; then
  echo "skipped: this system does not allow 'unshare -rn' (user and network namespaces)"
  exit 77
fi
exec unshare -rn sh -c "ip link set lo up && $route && exec \"\$0\" \"\$@\"" "$@"
