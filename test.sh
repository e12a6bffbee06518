#!/usr/bin/env bash
# Installs missing packages, builds mixbeam and runs its tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
# shellcheck source=.ci/setup.sh
source .ci/setup.sh

usage() {
  cat <<'END'
usage: ./test.sh [--no-install] [--headers] [--] [option of ctest]...

Installs missing Debian packages (for tests of pages also a browser without a screen), configures and builds the preset
"release", and runs the tests. ParaView's Python is installed for one test where that removes nothing, and a language server
of npm for another; without them these tests are skipped.

  --no-install   stop with the list of missing packages instead of installing them
  --headers      also compile each header alone (a few seconds for each one that includes Trilinos)
  --help         print this text

Options after "--" go to ctest, for example   ./test.sh -- -R kernels
Exit code: 0 all tests passed; 1 the build or a test failed; 2 wrong usage or missing packages.
END
}

install=yes
headers=no
while [[ $# -gt 0 ]]; do
  case $1 in
    --no-install) install=no ;;
    --headers) headers=yes ;;
    --help | -h) usage && exit 0 ;;
    --) shift && break ;;
    *) fail 2 "test.sh: unknown option $1; see ./test.sh --help" ;;
  esac
  shift
done

prepare "$install" "$browser_package" "$dask_package"
ensure_vtk "$install"
ensure_yaml_server "$install"
if [[ $headers == yes ]]; then
  say "Compile each header alone"
  cmake --build "$build_directory" --parallel "$(nproc)" --target verify_headers || fail 1 "A header is not complete."
fi
say "Test"
ctest --test-dir "$build_directory" --output-on-failure --no-tests=error --parallel 2 "$@" ||
  fail 1 "Tests failed (log: $build_directory/Testing/Temporary/LastTest.log)."
