# Sourced by demo/run, tests/run and tests/turn: installs missing Debian packages, and builds with a preset. Where there
# is no apt-get, it names the packages that are missing.

run_packages="g++ cmake ninja-build pkg-config libglew-dev libglfw3-dev libglm-dev libassimp-dev libdevil-dev
  libimgui-dev libegl-dev libgl-dev libegl1 libgl1-mesa-dri libopenexr-dev libfmt-dev libcli11-dev nlohmann-json3-dev"
test_packages="libgtest-dev xvfb xauth"
# Optional packages: the host osmesa, plots, and Embree, a baseline for rays.
optional_run_packages="libosmesa6-dev gnuplot-nox"
optional_test_packages="libembree-dev glslang-tools"
# For tests of the whole suite alone: packages, completions, the manual page, sample models; 40 MB to fetch. The
# report's page opens in Chromium, which is ten times as much: tests/long installs it.
full_test_packages="xdotool dpkg-dev lintian desktop-file-utils appstream fish zsh man-db assimp-testmodels"

# ctest runs as many tests at once as there are processors; override with its -j.
export CTEST_PARALLEL_LEVEL="${CTEST_PARALLEL_LEVEL:-$(nproc)}"

is_installed() {
  dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'
}

# show_progress WHAT LOG: copies lines to the log. Lines that begin with [N/M] appear on a terminal as one changing
# line, elsewhere as a line every 20 seconds.
show_progress() {
  local what="$1" log="$2" line step now last=0
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$log"
    case "$line" in "[0/"*) continue ;; "["[0-9]*/[0-9]*"]"*) ;; *) continue ;; esac
    step="${line%%]*}"
    step="${step#\[}"
    if [ -t 2 ]; then
      printf '\r\033[Klucerna: %s %s of %s' "$what" "${step%/*}" "${step#*/}" >&2
    else
      now="$(date +%s)"
      [ $((now - last)) -lt 20 ] || { last="$now"; echo "lucerna: $what ${step%/*} of ${step#*/}" >&2; }
    fi
  done
  [ ! -t 2 ] || printf '\r\033[K' >&2
}

# logged WHAT LOG COMMAND...: runs the command with show_progress; returns its exit status.
logged() {
  local what="$1" log="$2"
  shift 2
  rm -f "$log.ok"
  { "$@" 2>&1 && : >"$log.ok" || :; } | show_progress "$what" "$log"
  [ -e "$log.ok" ] && rm "$log.ok"
}

# apt_install NAME...: needs root; reports the number of packages set up.
apt_install() {
  local total
  total="$($become apt-get install -s --no-install-recommends "$@" 2>/dev/null | grep -c '^Inst ')" || :
  DEBIAN_FRONTEND=noninteractive \
    $become apt-get install -y -q --no-install-recommends -o Dpkg::Use-Pty=0 "$@" </dev/null 2>&1 |
    { count=0
      while IFS= read -r line; do
        case "$line" in "Setting up "*) count=$((count + 1)); line="[$count/$total] $line" ;; esac
        printf '%s\n' "$line"
      done; }
}

# package_name COLUMN NAME: what docs/packages.md calls this Debian package on Fedora (column 4) or Arch (5): nothing, a
# name, or several.
package_name() {
  awk -F'|' -v column="$1" -v name="$2" '
    {
      count = split($3, debian, /[` ]+/)
      for (i = 1; i <= count; i++) if (debian[i] == name) {
        listed = 1
        count = split($column, parts, "`")
        for (i = 2; i <= count; i += 2) print parts[i]
        exit
      }
    }
    END { if (!listed) print name }' docs/packages.md
}

# name_packages NAME... [-- OPTIONAL NAME...]: install_packages without apt-get. Names the missing packages and ends.
name_packages() {
  local column query install missing="" optional="" unknown="" name native needed=1
  if command -v dnf >/dev/null 2>&1; then column=4 query="rpm -q" install="dnf install"
  elif command -v pacman >/dev/null 2>&1; then column=5 query="pacman -Q" install="pacman -S"
  else
    echo "lucerna: no apt-get, dnf or pacman here; docs/packages.md lists what is needed" >&2
    return 0
  fi
  for name in "$@"; do
    [ "$name" != -- ] || { needed=""; continue; }
    native="$(package_name "$column" "$name")"
    [ -n "$native" ] || [ -z "$needed" ] || unknown="$unknown $name"
    for native in $native; do
      case "$missing$optional " in *" $native "*) continue ;; esac
      if $query "$native" >/dev/null 2>&1; then :
      elif [ "$needed" ]; then missing="$missing $native"
      else optional="$optional $native"
      fi
    done
  done
  [ -z "$unknown" ] || echo "lucerna: needed too, under a name that is not known here:$unknown (docs/packages.md)" >&2
  if [ -n "$missing" ]; then
    echo "lucerna: packages are missing: sudo $install$missing" >&2
    [ -z "$optional" ] || echo "lucerna: optional ones:$optional" >&2
    exit 3
  fi
  [ -z "$optional" ] || echo "lucerna: continuing without$optional" >&2
}

# install_packages NAME... [-- OPTIONAL NAME...]: installs missing packages, all at once. Optional ones are skipped if
# they do not exist, or cannot be installed without root.
install_packages() {
  local missing="" optional="" name needed=1 become=""
  command -v apt-get >/dev/null 2>&1 || { name_packages "$@"; return; }
  for name in "$@"; do
    if [ "$name" = -- ]; then needed=""
    elif is_installed "$name"; then :
    elif [ "$needed" ]; then missing="$missing $name"
    else optional="$optional $name"
    fi
  done
  [ -n "$missing$optional" ] || return 0
  if [ "$(id -u)" != 0 ]; then
    if [ -z "$missing" ]; then
      echo "lucerna: continuing without$optional" >&2
      return 0
    elif command -v sudo >/dev/null 2>&1; then
      become="sudo"
    else
      echo "lucerna: these Debian packages are missing, and installing them needs root or sudo:$missing" >&2
      exit 3
    fi
  fi
  $become apt-get update -qq || { echo "lucerna: apt-get update failed" >&2; exit 3; }
  for name in $optional; do
    if [ -n "$(apt-cache madison "$name" 2>/dev/null)" ]; then missing="$missing $name"
    else echo "lucerna: there is no package $name here; continuing without it" >&2
    fi
  done
  [ -n "$missing" ] || return 0
  echo "lucerna: installing$missing" >&2
  mkdir -p build
  : >build/packages.log
  logged "installing package" build/packages.log apt_install $missing || :
  for name in $missing; do
    is_installed "$name" || {
      tail -n 20 build/packages.log >&2
      echo "lucerna: apt-get install failed for $name (log: build/packages.log)" >&2
      exit 3
    }
  done
}

# build PRESET [CMAKE OPTION]...: configures and builds into build/PRESET, everything or the targets in $targets.
build() {
  local preset="$1" log
  shift
  log="build/$preset.log"
  mkdir -p build
  echo "lucerna: building (log: $log)" >&2
  if ! { cmake --preset "$preset" "$@" >"$log" 2>&1 &&
         logged "building" "$log" cmake --build --preset "$preset" ${targets:+--target $targets}; }; then
    tail -n 40 "$log" >&2
    exit 1
  fi
}
