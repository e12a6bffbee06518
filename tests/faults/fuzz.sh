#!/usr/bin/env bash
# Fuzzes what reads the input: scene, yaml, table, formula, batch, and result files (results), or those that are named.
# usage: tests/faults/fuzz.sh [-s SECONDS] [-b FOLDER] [TARGET...]      (clang-14 with libclang-rt-14-dev)
# Corpora come from apps/gallery, apps/verification and apps/batch. Exit code 0: nothing found; 1: the inputs that were found
# lie in FOLDER (build/fuzz), as crash-*, timeout-*, oom-*; FOLDER/fuzz_TARGET INPUT shows one again.
set -eu
seconds=600 root=$(realpath "$(dirname "$0")/../..") folder=
while getopts s:b: option; do case $option in s) seconds=$OPTARG ;; b) folder=$OPTARG ;; *) exit 2 ;; esac; done
shift $((OPTIND - 1))
folder=${folder:-$root/build/fuzz}
(($# > 0)) || set -- scene yaml table formula batch results
mkdir -p "$folder/objects"
flags=(-std=c++17 -O1 -g -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=undefined -fno-omit-frame-pointer
       -I"$root" -isystem /usr/include/trilinos -isystem /usr/include/libxml2
       -isystem /usr/lib/x86_64-linux-gnu/openmpi/include -isystem /usr/include/hdf5/openmpi)
compiler=(nice "$(command -v ccache || true)" clang++-14); [[ -n ${compiler[1]} ]] || compiler=(nice clang++-14)

# What reads, without kernels and Tpetra; result files need none of what reads scenes.
sources=("$root"/discretization/text/*.cpp)
if [[ $* != results ]]; then
  for room in parameters geometry scene reading reading/conditions; do sources+=("$root/discretization/$room"/*.cpp); done
  for check in expected_values mechanism rigid_parts; do sources+=("$root/discretization/checks/$check.cpp"); done
  sources+=("$root"/{discretization/mesh/mesh,kernels/math/gauss,apps/mixbeam/batch_parameters}.cpp)
fi
for part in disk_file guarded_file hdf5_copy hdf5_driver hdf5_writer records step_records stored_run seal verify result_tables; do
  sources+=("$root/discretization/results/$part.cpp")
done
objects=()
for source in "${sources[@]}"; do
  object=$folder/objects/$(tr / - <<<"${source#"$root"/}").o
  objects+=("$object")
  [[ $object -nt $source ]] || echo "$source" "$object"
done | xargs -r -L1 -P "${JOBS:-1}" "${BASH:-bash}" -c '"${@:1:$#-2}" -c "${@: -2:1}" -o "${@: -1}"' _ "${compiler[@]}" "${flags[@]}"
for source in "${sources[@]}"; do objects+=("$folder/objects/$(tr / - <<<"${source#"$root"/}").o"); done

found=0
for target; do
  "${compiler[@]}" "${flags[@]}" -DFUZZ_TARGET="$target" -DFUZZ_"${target^^}" -c "$root/tests/faults/fuzz.cpp" -o "$folder/$target.o"
  clang++-14 -fsanitize=address,undefined,fuzzer "$folder/$target.o" "${objects[@]}" -o "$folder/fuzz_$target" \
    -ltrilinos_teuchosparameterlist -ltrilinos_teuchosparser -ltrilinos_teuchoscomm -ltrilinos_teuchoscore -lxml2 -lyaml-cpp -lmuparser -lgsl -lgslcblas \
    -lhdf5_openmpi -lxxhash -L/usr/lib/x86_64-linux-gnu/openmpi/lib -lmpi
  corpus=$folder/corpus_$target; mkdir -p "$corpus"
  case $target in
    scene) for xml in "$root"/apps/*/*.xml; do cp "$xml" "$corpus/$(basename "$(dirname "$xml")")-$(basename "$xml")"; done ;;
    yaml) for xml in "$root"/apps/*/*.xml; do
            "$root/build/release/bin/mixbeam" convert --force "$xml" "$corpus/$(basename "$(dirname "$xml")")-$(basename "$xml" .xml).yaml"
          done ;;
    table) { cat "$root/tests/faults/points.csv"; echo =====; cat "$root/tests/faults/members.csv"; } >"$corpus/column" ;;
    formula) grep -oh 'value="[^"{}]*[*/^(][^"{}]*"' "$root"/apps/*/*.xml | sort -u | cut -d'"' -f2 | split -l 1 - "$corpus/" ;;
    batch) for xml in "$root"/apps/batch/*.xml "$root"/tests/faults/column.xml; do
             { echo '<ParameterList name="b">'; sed -n '/<ParameterList name="Batch">/,$p' "$xml" | sed 's/"[a-z_]*.csv"/"table.csv"/'; echo =====; cat "$root"/apps/batch/*.csv; } >"$corpus/$(basename "$xml")"
           done ;;
    results) "$root/build/release/bin/mixbeam" run "$root/apps/verification/von_mises_truss.xml" --quiet --output "$folder" >/dev/null
             export FUZZ_RESULT=$folder/von_mises_truss.h5; echo forged >"$corpus/forged" ;;
  esac
  grep -oh '"[^"\\]*"' "$root"/apps/{gallery,verification,batch}/*.xml | sort -u | awk 'length($0) > 3 && length($0) < 40' >"$folder/words"
  printf '"%s"\n' 'sin(' 'sqrt(' 'atan2(' 'exp(' 'rint(' 'avg(' 'sum(' 'pi' '?' ':' '&&' '==' '1e308' '^' >>"$folder/words"
  (cd "$folder" && nice "./fuzz_$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=20000 -dict=words \
    -print_final_stats=1 -verbosity=0 -detect_leaks=0 -artifact_prefix="$folder/" "$corpus") || found=1
done
exit $found
