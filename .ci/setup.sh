# Common part of run.sh and test.sh, which source it in the root of the repository.
# prepare() installs missing Debian packages, configures the preset "release" and builds it.
# shellcheck shell=bash

readonly preset=release
readonly build_directory=build/$preset

readonly required_packages=(
  g++ cmake ninja-build ccache git pkg-config
  libtrilinos-tpetra-dev libtrilinos-nox-dev libtrilinos-amesos2-dev libtrilinos-teuchos-dev
  libtrilinos-kokkos-dev libtrilinos-kokkos-kernels-dev
  # included by headers of the above, though their packages do not depend on these
  libtrilinos-thyra-dev libtrilinos-belos-dev libtrilinos-epetra-dev libtrilinos-rtop-dev
  libtrilinos-anasazi-dev libtrilinos-shylu-dev
  libtrilinos-sacado-dev libgtest-dev libbenchmark-dev
  # factorises matrices of networks and counts negative pivots of symmetric matrices, which no solver of Trilinos does;
  # METIS provides its ordering
  libmumps-dev libmetis-dev
  # a fast BLAS for MUMPS, which update-alternatives prefers to the reference BLAS. The program limits it to one thread,
  # since sums would depend on the number, but calls it from several: the package "serial" has no locks
  # (blas_setup.hpp). thread_scaling measures its unit with the reference BLAS
  libopenblas0-pthread libblas3 liblapack3
  libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libxml2-dev nlohmann-json3-dev
  libmuparser-dev libgsl-dev libnlopt-dev libxxhash-dev zlib1g-dev
  python3-matplotlib python3-h5py
  # scenes in YAML; the module for Python
  libyaml-cpp-dev pybind11-dev python3-dev
  # tests: the JSON Schema of scenes, steps of the first hour
  python3-jsonschema python3-yaml
)

# One test opens results with VTK's XDMF reader. Debian's python3-vtk9 lacks it; ParaView's Python has it, is a download
# of 120 MB and conflicts with python3-vtk9. So only test.sh installs it, without removing packages; the test is skipped
# without it.
readonly vtk_package=python3-paraview

# One test queries the language server of VS Code's YAML extension for completions and diagnostics of a scene. Node.js and
# npm are 355 packages of Debian, but only 23 MB to download; the server takes 29 MB in the build folder. Its version 2
# needs Node.js 22, Debian has 18. As above, only test.sh installs it, and the test is skipped without it.
readonly yaml_server=yaml-language-server@1.15.0

# Opens the pages of mixbeam view headless and renders WebGL without a GPU. Only test.sh installs it (80 MB); no test is
# skipped without it.
readonly browser_package=chromium-headless-shell

# Workers that share a batch, for one test. Only test.sh installs it.
readonly dask_package=python3-distributed

say() { printf '== %s\n' "$*"; }
fail() { # fail <exit code> <message>...
  local code=$1
  shift
  printf '%s\n' "$@" >&2
  exit "$code"
}

status_of() { # status_of <package>
  dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null
}

missing_packages() { # missing_packages [further package]...
  local package
  for package in "${required_packages[@]}" "$@"; do
    [[ $(status_of "$package") == installed ]] || printf '%s\n' "$package"
  done
}

as_root() {
  if [[ $EUID -eq 0 ]]; then
    "$@"
  else
    sudo -- "$@"
  fi
}

install_packages() { # install_packages [option of apt-get install]... <package>...
  local packages=() argument
  for argument in "$@"; do [[ $argument == -* ]] || packages+=("$argument"); done
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get --yes --quiet)
  local install_command=("${apt[@]}" install --no-install-recommends "$@")
  # A fresh container has no package lists; those of an old machine may be outdated.
  if apt-cache show "${packages[@]}" >/dev/null 2>&1 && as_root "${install_command[@]}"; then return; fi
  as_root "${apt[@]}" update && as_root "${install_command[@]}"
}

ensure_packages() { # ensure_packages <install: yes|no> [further package]...
  if ! command -v dpkg-query >/dev/null; then
    say "Not a Debian system: packages are not checked, the configuration will say what is missing"
    return
  fi
  local missing
  mapfile -t missing < <(missing_packages "${@:2}")
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

ensure_vtk() { # ensure_vtk <install: yes|no>; never ends the script
  command -v dpkg-query >/dev/null || return 0
  [[ $(status_of "$vtk_package") == installed ]] && return 0
  if [[ $1 == yes ]] && { [[ $EUID -eq 0 ]] || command -v sudo >/dev/null; }; then
    say "Missing Debian package: $vtk_package (for one test)"
    install_packages --no-remove "$vtk_package" && return 0
  fi
  export MIXBEAM_TOOLS_MISSING=yes
  say "Without $vtk_package, which one test needs: it is skipped. By hand, as root:"
  printf '    apt-get install --no-install-recommends --no-remove %s\n' "$vtk_package"
}

ensure_yaml_server() { # ensure_yaml_server <install: yes|no>; never ends the script
  local folder=$build_directory/yaml-language-server
  [[ -d $folder/node_modules/yaml-language-server ]] && return 0
  if [[ $1 == yes ]]; then
    if ! command -v npm >/dev/null && command -v dpkg-query >/dev/null; then
      say "Missing Debian packages: nodejs npm (for one test)"
      install_packages --no-remove nodejs npm || true
    fi
    mkdir -p "$folder"
    npm install --prefix "$folder" --no-audit --no-fund "$yaml_server" && return 0
  fi
  export MIXBEAM_TOOLS_MISSING=yes
  say "Without $yaml_server, which one test needs: it is skipped. By hand:"
  printf '    npm install --prefix %s %s\n' "$folder" "$yaml_server"
}

prepare() { # prepare <install: yes|no> [further package]...
  ensure_packages "$@"
  say "Configure ($preset)"
  cmake --preset "$preset" --log-level=NOTICE || fail 1 "Configuring failed."
  say "Build ($build_directory)"
  cmake --build "$build_directory" --parallel "$(nproc)" || fail 1 "Building failed."
}
