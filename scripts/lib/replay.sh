# shellcheck shell=bash
# Builds slamgc-replay, and draws what it wrote. To be sourced, after packages.sh.

build_replay() { # FOLDER: leaves the program's path in REPLY
  cmake -S . -B "$1" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSLAMGC_BUILD_EXAMPLES=ON -DSLAMGC_EXAMPLES=all \
    -DSLAMGC_BUILD_TESTS=OFF -DSLAMGC_BUILD_BENCH=OFF >/dev/null
  cmake --build "$1" --target slamgc-replay
  REPLY=$(realpath "$1")/examples/replay/slamgc-replay
}

# Which Python has matplotlib: its package is for the distribution's own.
find_matplotlib() {
  for REPLY in python3 /usr/bin/python3; do
    ! "$REPLY" -c 'import matplotlib' 2>/dev/null || return 0
  done
  return 1
}
