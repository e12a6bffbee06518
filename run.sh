#!/usr/bin/env bash
# Installs what is missing, builds mixbeam, and computes the benchmarks with their tables and pictures.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
# shellcheck source=.ci/setup.sh
source .ci/setup.sh

readonly all_benchmarks=(rollup superimposed_rotation arc_segment helix helical_rod slope_discontinuity fork)
readonly results=results
# Debian's Python has the packages installed above; another one earlier in PATH need not.
readonly python=/usr/bin/python3

usage() {
  cat <<END
usage: ./run.sh [--no-install] [benchmark]...

Installs missing Debian packages, configures and builds the preset "release", and runs the benchmarks:
  ${all_benchmarks[*]}
or those that are named. Tables, result files and pictures go to $results/<benchmark>.

  --no-install   stop with the list of missing packages instead of installing them
  --help         print this text

Exit code: 0 every checked value agrees; 1 the build or a benchmark failed; 2 wrong usage or missing packages.
END
}

install=yes
benchmarks=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --no-install) install=no ;;
    --help | -h) usage && exit 0 ;;
    -*) fail 2 "run.sh: unknown option $1; see ./run.sh --help" ;;
    *)
      [[ " ${all_benchmarks[*]} " == *" $1 "* ]] ||
        fail 2 "run.sh: unknown benchmark $1; there are: ${all_benchmarks[*]}"
      benchmarks+=("$1")
      ;;
  esac
  shift
done
[[ ${#benchmarks[@]} -gt 0 ]] || benchmarks=("${all_benchmarks[@]}")

prepare "$install"

# Threads that wait for work spin by default: beside anything else that runs on the machine, small scenes then take many
# times as long.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

failed=()
for benchmark in "${benchmarks[@]}"; do
  say "Run $benchmark"
  program=$build_directory/bin/$benchmark
  if [[ ! -x $program ]]; then
    printf 'There is no program %s\n' "$program" >&2
    failed+=("$benchmark")
    continue
  fi
  mkdir -p "$results/$benchmark"
  "$program" --output "$results/$benchmark" --summary "$results/$benchmark/summary.json" ||
    failed+=("$benchmark")
done

plot_script=$build_directory/bin/plots/plot_all.py
if [[ -f $plot_script ]]; then
  say "Draw the figures"
  MPLBACKEND=Agg "$python" "$plot_script" "$results" || failed+=("figures")
fi

table_script=$build_directory/bin/plots/verification_table.py
if [[ -f $table_script ]]; then
  say "Verification"
  "$python" "$table_script" "$results" || failed+=("verification table")
fi

say "Results"
for benchmark in "${benchmarks[@]}"; do
  [[ -d $results/$benchmark ]] || continue
  for kind in csv png json; do
    files=$(find "$results/$benchmark" -name "*.$kind" | wc -l)
    [[ $files -eq 0 ]] || printf '%-24s %3d %s in %s\n' "$benchmark" "$files" "$kind" "$PWD/$results/$benchmark"
  done
done
if [[ ${#failed[@]} -gt 0 ]]; then
  fail 1 "Failed: ${failed[*]}"
fi
say "All ${#benchmarks[@]} benchmarks agree with their references"
