# Sourced by demo/run and tests/run: installs the Debian packages that are missing, and builds with a preset.

run_packages="g++ cmake ninja-build pkg-config libglew-dev libglfw3-dev libglm-dev libassimp-dev libdevil-dev libosmesa6-dev
  libegl-dev libgl-dev libegl1 libgl1-mesa-dri libopenexr-dev libfmt-dev libcli11-dev nlohmann-json3-dev gnuplot-nox"
test_packages="libgtest-dev xvfb xauth libembree-dev"

# install_packages NAME...: those that are missing, all at once.
install_packages() {
  local missing="" name
  for name in "$@"; do
    dpkg-query -W -f='${Status}' "$name" 2>/dev/null | grep -q 'ok installed' || missing="$missing $name"
  done
  [ -n "$missing" ] || return 0
  local become=""
  if [ "$(id -u)" != 0 ]; then
    if command -v sudo >/dev/null 2>&1; then
      become="sudo"
    else
      echo "lucerna: these Debian packages are missing, and neither root nor sudo is there to install them:$missing" >&2
      exit 3
    fi
  fi
  echo "lucerna: installing$missing" >&2
  $become apt-get update -qq || { echo "lucerna: apt-get update fails" >&2; exit 3; }
  DEBIAN_FRONTEND=noninteractive $become apt-get install -y -qq --no-install-recommends $missing >/dev/null ||
    { echo "lucerna: apt-get install fails for:$missing" >&2; exit 3; }
}

# build PRESET [CMAKE OPTION]...: configures and builds into build/PRESET.
build() {
  local preset="$1" log
  shift
  log="build/$preset.log"
  mkdir -p build
  echo "lucerna: building (log: $log)" >&2
  if ! { cmake --preset "$preset" "$@" && cmake --build --preset "$preset"; } >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    exit 1
  fi
}
