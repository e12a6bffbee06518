#!/usr/bin/env bash
# Installs missing packages, builds mixbeam, and runs the benchmarks and the scenes of apps/verification and
# apps/gallery with their tables and pictures; studies of cost only if named.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
# shellcheck source=.ci/setup.sh
source .ci/setup.sh

readonly default_benchmarks=(rollup superimposed_rotation arc_segment helix helical_rod slope_discontinuity fork modes sensitivity extremes)
readonly when_named=(trade economies peers) # a quarter of an hour each
readonly all_benchmarks=("${default_benchmarks[@]}" "${when_named[@]}")
readonly all_scene_groups=(verification gallery)
readonly default_names=("${default_benchmarks[@]}" "${all_scene_groups[@]}")
readonly all_names=("${all_benchmarks[@]}" "${all_scene_groups[@]}")
readonly peer_packages=(python3-dolfinx calculix-ccx)
readonly results=results
# Debian's Python has the packages installed above, which another one in PATH may lack.
readonly python=(/usr/bin/python3 -E -s) # ignores PYTHONPATH and ~/.local

usage() {
  cat <<END
usage: ./run.sh [--no-install] [--with-peers] [name]...

Installs missing Debian packages, configures and builds the preset "release", and runs the benchmarks
  ${default_benchmarks[*]}
and the scenes of
  ${all_scene_groups[*]}
(two to four minutes), or those that are named. Studies of cost run only where they are named (a quarter of an hour each):
  ${when_named[*]}
The last one compares mixbeam with those of ${peer_packages[*]} that are installed.
Tables, result files and pictures go to $results/<name>.

  --with-peers   install ${peer_packages[*]} too, which nothing but the study peers uses
  --no-install   stop with the list of missing packages instead of installing them
  --help         print this text

Exit code: 0 every checked value agrees; 1 the build or a run failed; 2 wrong usage or missing packages.
END
}

# Runs every scene of apps/<group>; prints a line for each, or the report of a failed run.
run_scenes() { # run_scenes <group>
  local scene name folder
  for scene in apps/"$1"/*.xml apps/"$1"/*.yaml; do
    [[ -e $scene ]] || continue
    name=$(basename "${scene%.*}")
    folder=$results/$1/$name
    mkdir -p "$folder"
    rm -f "$folder/summary.json" # of an earlier run; an early failure writes none
    if "$program_mixbeam" run "$scene" --quiet --output "$folder" --summary "$folder/summary.json" \
      >"$folder/report.txt" 2>&1; then
      printf '%-24s %s\n' "$name" "$(grep 'checks passed' "$folder/report.txt")"
    else
      cat "$folder/report.txt" >&2
      failed+=("$1/$name")
    fi
  done
}

draw_scenes() { # draw_scenes <group>
  local file shapes=() envelopes=()
  while IFS= read -r -d '' file; do
    if [[ -e ${file%.h5}-envelope.csv ]]; then envelopes+=("$file"); else shapes+=("$file"); fi
  done < <(find "$results/$1" -name '*.h5' ! -name '*-identification.h5' ! -name '*-design.h5' -print0)
  : >"$results/$1/pictures.txt"
  draw_each "$1" shape "${shapes[@]}"
  draw_each "$1" envelope "${envelopes[@]}"
}

draw_each() { # draw_each <group> <picture> <results>...
  local group=$1 picture=$2
  shift 2
  (($# > 0)) || return 0
  printf '%s\0' "$@" |
    MPLBACKEND=Agg xargs -0 -r -n 1 -P "$(nproc)" "${python[@]}" "$build_directory/bin/plots/plot_result.py" \
      --picture "$picture" --format png >>"$results/$group/pictures.txt" || failed+=("pictures of $group")
}

install=yes
further=()
names=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --no-install) install=no ;;
    --with-peers) further=("${peer_packages[@]}") ;;
    --help | -h) usage && exit 0 ;;
    -*) fail 2 "run.sh: unknown option $1; see ./run.sh --help" ;;
    *)
      [[ " ${all_names[*]} " == *" $1 "* ]] ||
        fail 2 "run.sh: unknown benchmark $1; there are: ${all_names[*]}"
      names+=("$1")
      ;;
  esac
  shift
done
[[ ${#names[@]} -gt 0 ]] || names=("${default_names[@]}")
readonly program_mixbeam=$build_directory/bin/mixbeam

prepare "$install" "${further[@]}"

# Waiting threads spin by default: beside other processes, small scenes then take many times as long.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

failed=()
verified=no # studies of cost compare times, not values
for benchmark in "${names[@]}"; do
  say "Run $benchmark"
  [[ " ${when_named[*]} " == *" $benchmark "* ]] || verified=yes
  if [[ " ${all_scene_groups[*]} " == *" $benchmark "* ]]; then
    run_scenes "$benchmark"
    continue
  fi
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
  drawn=()
  for benchmark in "${all_benchmarks[@]}"; do
    [[ " ${names[*]} " == *" $benchmark "* ]] && drawn+=("$benchmark")
  done
  [[ ${#drawn[@]} -eq 0 ]] ||
    MPLBACKEND=Agg "${python[@]}" "$plot_script" "$results" --only "${drawn[@]}" || failed+=("figures")
  for group in "${all_scene_groups[@]}"; do
    [[ " ${names[*]} " != *" $group "* ]] || draw_scenes "$group"
  done
fi

table_script=$build_directory/bin/plots/verification_table.py
if [[ -f $table_script && $verified == yes ]]; then
  say "Verification"
  "${python[@]}" "$table_script" "$results" || failed+=("verification table")
fi

say "Results"
for benchmark in "${names[@]}"; do
  [[ -d $results/$benchmark ]] || continue
  for kind in csv png json; do
    files=$(find "$results/$benchmark" -name "*.$kind" | wc -l)
    [[ $files -eq 0 ]] || printf '%-24s %3d %s in %s\n' "$benchmark" "$files" "$kind" "$PWD/$results/$benchmark"
  done
done
if [[ ${#failed[@]} -gt 0 ]]; then
  fail 1 "Failed: ${failed[*]}"
fi
say "All values agree with their references: ${names[*]}"
