# Sourced by run.sh and test.sh from the root of the repository: the part they share.
# prepare() installs missing Debian packages, configures the preset "release" and builds it.
# shellcheck shell=bash

readonly preset=release
readonly build_directory=build/$preset

readonly required_packages=(
  g++ cmake ninja-build ccache git pkg-config
  libtrilinos-tpetra-dev libtrilinos-nox-dev libtrilinos-amesos2-dev libtrilinos-teuchos-dev
  libtrilinos-kokkos-dev libtrilinos-kokkos-kernels-dev
  # included by the headers of those above, although their packages do not say so
  libtrilinos-thyra-dev libtrilinos-belos-dev libtrilinos-epetra-dev libtrilinos-rtop-dev
  libtrilinos-anasazi-dev libtrilinos-shylu-dev
  libtrilinos-sacado-dev libgtest-dev
  libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libxml2-dev nlohmann-json3-dev
  libmuparser-dev libgsl-dev
  python3-matplotlib python3-h5py
  python3-vtk9 # a test opens the results with VTK's own readers
)

say() { printf '== %s\n' "$*"; }
fail() { # fail <exit code> <message>...
  local code=$1
  shift
  printf '%s\n' "$@" >&2
  exit "$code"
}

missing_packages() {
  local package
  for package in "${required_packages[@]}"; do
    [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
      printf '%s\n' "$package"
  done
}

as_root() {
  if [[ $EUID -eq 0 ]]; then
    "$@"
  else
    sudo -- "$@"
  fi
}

install_packages() {
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get --yes --quiet)
  local install_command=("${apt[@]}" install --no-install-recommends "$@")
  # A fresh container has no package lists; an old machine has lists of packages that are gone.
  if apt-cache show "$@" >/dev/null 2>&1 && as_root "${install_command[@]}"; then return; fi
  as_root "${apt[@]}" update && as_root "${install_command[@]}"
}

ensure_packages() { # ensure_packages <install: yes|no>
  if ! command -v dpkg-query >/dev/null; then
    say "Not a Debian system: packages are not checked, the configuration will say what is missing"
    return
  fi
  local missing
  mapfile -t missing < <(missing_packages)
  [[ ${#missing[@]} -gt 0 ]] || return 0
  local by_hand="apt-get install --no-install-recommends ${missing[*]}"
  say "Missing Debian packages: ${missing[*]}"
  if [[ $1 == no ]]; then
    fail 2 "Not installed, because of --no-install. Install them with" "    $by_hand"
  fi
  if [[ $EUID -ne 0 ]] && ! command -v sudo >/dev/null; then
    fail 2 "Installing needs root or sudo. As root:" "    $by_hand"
  fi
  install_packages "${missing[@]}" || fail 2 "The packages could not be installed. By hand, as root:" "    $by_hand"
}

prepare() { # prepare <install: yes|no>
  ensure_packages "$1"
  say "Configure ($preset)"
  cmake --preset "$preset" --log-level=NOTICE || fail 1 "Configuring failed."
  say "Build ($build_directory)"
  cmake --build "$build_directory" --parallel "$(nproc)" || fail 1 "Building failed."
}
