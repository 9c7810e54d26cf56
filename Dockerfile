# Image to build, test and fly vantage: Debian 12 with the packages that tools/setup installs.
#   docker build --tag vantage .
#   docker run --rm -it --volume "$PWD:/work" --workdir /work vantage tools/test
# The bus needs multicast on loopback: run with --cap-add NET_ADMIN and, once inside,
# `ip route add 224.0.0.0/4 dev lo`; or with --network host. Tests in network namespaces of their own
# need --privileged; they are skipped without.
FROM debian:12
COPY tools/setup /tmp/vantage/tools/setup
RUN CI=1 /tmp/vantage/tools/setup --apt \
  && rm -rf /tmp/vantage /var/lib/apt/lists/*
