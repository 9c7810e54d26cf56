#!/bin/bash
# peers.sh BIN_DIR: three hosts on a switch exchange messages by unicast (URL option peers), two processes on
# each. Every process must receive complete messages from all others, both single-datagram and
# many-datagram ones, although 1 % of the frames are lost. Multicast must not leave a host. Runs in its own network: in_network.sh peers.sh …
set -euo pipefail
bin=$1
switch=$(dirname "$0")/../rig/switch
url="udpm://239.255.76.67:7667?peers=10.77.0.1:7668,10.77.0.2:7668,10.77.0.3:7668"
all=(A1 A2 B1 B2 C1 C2)
# Prints the command of one host: its two processes; the exit code is nonzero if one fails.
host() {
  echo "$bin/peers_node '$url' ${1}1 ${all[*]/${1}1} & $bin/peers_node '$url' ${1}2 ${all[*]/${1}2} && wait \$!"
}
"$switch" --seed 1 --loss 0.01 -- bash -c "$(host A)" -- bash -c "$(host B)" -- bash -c "$(host C)"
