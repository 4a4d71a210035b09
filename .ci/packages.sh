# need PACKAGE...: installs the Debian packages that are missing. Where it cannot, it says which they are and goes on: CMake
# fetches the libraries from their repositories instead. Sourced by examples/run.sh, tests/run.sh and the gates.
need() {
  missing=
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  as_root=
  if [ "$(id -u)" -ne 0 ]; then
    as_root="sudo -n"
    $as_root true 2>/dev/null || as_root=none
  fi
  if [ "$as_root" = none ] || ! command -v apt-get >/dev/null; then
    echo "Not installed, and this user cannot install:$missing"
    return 0
  fi
  echo "Installing:$missing"
  { $as_root apt-get update -q && $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $missing; } \
    >"${TMPDIR:-/tmp}/motionlang-packages.log" 2>&1 ||
    echo "apt-get failed, see ${TMPDIR:-/tmp}/motionlang-packages.log; going on without"
}

# configure PRESET: quietly, with $options, if set.
configure() {
  command -v cmake >/dev/null || { echo "cmake (3.24 or newer) is needed: https://cmake.org/download"; exit 1; }
  generator=Ninja
  command -v ninja >/dev/null || generator="Unix Makefiles"
  cmake --preset "$1" -G "$generator" ${options:-} >"${TMPDIR:-/tmp}/motionlang-configure.log" 2>&1 ||
    { sed -n '/CMake Error/,$p' "${TMPDIR:-/tmp}/motionlang-configure.log"; exit 1; }
}

# build PRESET TARGET...: configures and compiles, with progress.
build() {
  preset=$1
  shift
  configure "$preset"
  cmake --build "build/$preset" -j "$(nproc)" ${1:+--target "$@"}
}
