# shellcheck shell=bash
# Which packages of Debian and Ubuntu each purpose needs, and how they get onto the machine.
# Nothing else names a package. To be sourced.

# packages_of PURPOSE: PACKAGE or PACKAGE=PROOF, where PROOF is a command or a file that does as well.
# With a question mark in front: what needs it is skipped, visibly, where the distribution has no
# such package.
packages_of() {
  case "$1" in
    build) echo cmake=cmake ninja-build=ninja ;;
    demo) echo g++=c++ '?zlib1g-dev' '?libcli11-dev' '?nlohmann-json3-dev' '?libfmt-dev' ;;
    replay) echo g++=c++ zlib1g-dev=/usr/include/zlib.h libcli11-dev=/usr/include/CLI/CLI.hpp nlohmann-json3-dev=/usr/include/nlohmann/json.hpp libfmt-dev=/usr/include/fmt/format.h '?liburcu-dev=/usr/include/urcu-qsbr.h' '?libgc-dev=/usr/include/gc/gc.h' ;;
    report) echo python3=python3 '?python3-matplotlib' ;;
    pictures) echo graphviz=dot ;;
    gtest) echo python3=python3 patch=patch libgtest-dev=/usr/include/gtest/gtest.h '?graphviz=dot' ;;
    docs) echo python3=python3 doxygen=doxygen '?clang-format-14' '?clang-tidy-14' '?shellcheck' ;;
    gcc-release)
      packages_of gtest
      packages_of mini_orb
      echo pkg-config=pkg-config libboost-dev=/usr/include/boost/version.hpp valgrind=valgrind libbenchmark-dev '?relacy-dev' '?python3-matplotlib' '?zlib1g-dev' '?libcli11-dev' '?nlohmann-json3-dev' '?libfmt-dev' '?chromium=chromium' '?liburcu-dev=/usr/include/urcu-qsbr.h' '?libgc-dev=/usr/include/gc/gc.h'
      ;;
    mini_orb) echo libeigen3-dev=/usr/include/eigen3/Eigen/Core ;;
    gcc-asan | gcc-tsan)
      packages_of gtest
      packages_of mini_orb
      ;;
    benchmark)
      packages_of mini_orb
      echo python3=python3 libboost-dev libbenchmark-dev valgrind=valgrind '?zlib1g-dev' '?python3-matplotlib' '?liburcu-dev' '?libxenium-dev' '?libcds-dev'
      ;;
    clang)
      packages_of gtest
      # libFuzzer comes with the runtime libraries of the clang that was chosen.
      [[ ${SLAMGC_CLANGXX:-} != clang++-[0-9]* ]] || echo "?libclang-rt-${SLAMGC_CLANGXX#clang++-}-dev"
      ;;
    gcc-oldest)
      packages_of gtest
      echo gcovr=gcovr
      ;;
    aarch64) echo python3=python3 '?googletest' '?g++-aarch64-linux-gnu' '?qemu-user=qemu-aarch64' ;;
    g++-*) echo "$1=$1" ;;
    clang++-*) echo "clang-${1#clang++-}=$1" ;;
    *) packages_of gtest ;; # all other lanes
  esac
}

# Whether apt-get can be used here: there is one, and we are root or may become root.
can_install() {
  [[ -x $(command -v apt-get) ]] || return 1
  [[ $EUID == 0 ]] && return
  [[ -x $(command -v sudo) ]] && { [[ -t 0 ]] || sudo -n true 2>/dev/null; }
}

as_root() {
  if [[ $EUID == 0 ]]; then "$@"; else sudo "$@"; fi
}

apt_updated=
update_lists() {
  [[ -z $apt_updated ]] || return 0
  apt_updated=yes
  echo "-- apt-get update"
  # A source that does not answer is no reason to give up: the package may be in another one.
  as_root apt-get update -q </dev/null || echo "-- apt-get update failed; going on with what is known"
}

# Whether the distribution has this package.
is_known() {
  can_install || return 1
  compgen -G '/var/lib/apt/lists/*Packages*' >/dev/null || update_lists
  # A name with a plus that it does not know is a regular expression to apt-cache; so give it one.
  [[ $(LC_ALL=C apt-cache policy "^${1//+/\\+}\$" 2>/dev/null) == *'Candidate: '[^\(]* ]]
}

is_installed() { # PACKAGE PROOF
  if [[ $2 == /* ]]; then
    [[ ! -e $2 ]] || return 0
  elif [[ -n $2 && -x $(command -v "$2") ]]; then
    return 0
  fi
  [[ $(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

# install_packages PURPOSE...: installs what is missing. Ends the script if it cannot.
install_packages() {
  local purpose word package proof required=() optional=() wanted=()
  for purpose in "$@"; do
    for word in $(packages_of "$purpose"); do
      package=${word#\?}
      package=${package%%=*}
      proof=
      [[ $word != *=* ]] || proof=${word#*=}
      [[ " ${required[*]} ${optional[*]} " != *" $package "* ]] || continue
      is_installed "$package" "$proof" && continue
      if [[ $word == \?* ]]; then optional+=("$package"); else required+=("$package"); fi
    done
  done
  [[ ${#required[@]} -gt 0 || ${#optional[@]} -gt 0 ]] || return 0

  if ! can_install; then
    for package in "${optional[@]}"; do echo "-- $package is missing: what needs it is skipped"; done
    [[ ${#required[@]} -gt 0 ]] || return 0
    {
      echo "Missing packages (names of Debian and Ubuntu): ${required[*]}"
      echo "They cannot be installed from here: that needs apt-get, and root or sudo without a"
      echo "password. Install them, or what corresponds to them, and start again."
    } >&2
    exit 1
  fi

  update_lists
  wanted=("${required[@]}")
  for package in "${optional[@]}"; do
    if is_known "$package"; then
      wanted+=("$package")
    else
      echo "-- this distribution has no $package: what needs it is skipped"
    fi
  done
  [[ ${#wanted[@]} -gt 0 ]] || return 0
  echo "-- apt-get install ${wanted[*]}"
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends \
    -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300 "${wanted[@]}" </dev/null
}

# newest COMMAND VERSION...: puts the first COMMAND-VERSION that is here or can be had into REPLY.
# COMMAND is g++ or clang++.
newest() {
  local command=$1 version
  shift
  for version in "$@"; do
    REPLY=$command-$version
    [[ ! -x $(command -v "$REPLY") ]] || return 0
    ! is_known "${command/clang++/clang}-$version" || return 0
  done
  REPLY=
  return 1
}
