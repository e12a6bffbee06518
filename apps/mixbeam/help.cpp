#include "apps/mixbeam/commands.hpp"

#include <map>

namespace mixbeam {

namespace {

constexpr const char* kExitCodes =
    "exit code: 0 done and all checks passed, 1 a check failed, 2 bad input, 3 no convergence,\n"
    "           130 stopped by Ctrl-C (the results so far are written)\n";

const char* const kProgram =
    "mixbeam: static equilibrium of structures of geometrically exact beams\n\n"
    "usage: mixbeam COMMAND [arguments]\n\n"
    "A scene is a file in XML or YAML: SCENE.xml, SCENE.yaml.\n\n"
    "  run SCENE.xml       solves a scene and writes its results\n"
    "  batch SCENE.xml     solves many cases of a scene at once: a table of parameters, or a grid\n"
    "  check SCENE.xml     reads, validates and measures a scene; solves nothing\n"
    "  convert SCENE.xml SCENE.yaml    writes a scene in YAML, or back in XML\n"
    "  parameters          lists every parameter of a scene file: type, default, range, meaning\n"
    "  schema              what editors complete and check scenes with: RELAX NG, or JSON Schema for YAML\n"
    "  resume RESULTS.h5   continues a run that was stopped or killed\n"
    "  plot RESULTS.h5     draws pictures of results, or of a scene that is not solved\n"
    "  report RESULTS.h5   writes one HTML page about a run\n"
    "  view RESULTS.h5     writes one HTML file that shows the structure, or a scene, in a browser, to turn and to "
    "ask\n"
    "  verify RESULTS.h5   checks that a result file is what was written\n\n"
    "mixbeam COMMAND --help tells more; mixbeam --version prints the version.\n\n";

const std::map<std::string, const char*>& texts() {
  static const std::map<std::string, const char*> all = {
      {"run",
       "usage: mixbeam run SCENE.xml [options]\n\n"
       "Solves a scene; with several load cases one after the other, each from the undeformed structure. Writes\n"
       "  DIR/NAME.h5            every converged step: shape, forces, strains, energies, reactions, residuals, state\n"
       "  DIR/NAME.xdmf          the same for ParaView and VisIt: open this file there\n"
       "  DIR/NAME-monitor.csv   what is followed over the steps: load factor, displacements, reactions, energies\n"
       "where NAME is that of the scene file without its ending, with -CASE after it for each load case. The list "
       "\"Study\"\n"
       "of a benchmark's scene is ignored.\n\n"
       "  -o, --output DIR     folder for results; default: results/NAME\n"
       "  --case NAME          only this load case\n"
       "  --jobs N             up to N load cases at once, each in a process of its own with its share of the\n"
       "                       processors; results are the same bits. Not under mpirun\n"
       "  --threads N          OpenMP threads; default: \"Threads\" in the scene, else OMP_NUM_THREADS, else all\n"
       "                       processors for scenes that are large enough to profit; results are the same bits\n"
       "  --summary FILE.json  every checked quantity, steps, iterations and times, for scripts\n"
       "  --durable            every step waits until it is on the disk: a power cut loses none. Without it only "
       "steps\n"
       "                       do that take 30 times as long as the waiting, and the last one\n"
       "  --quiet              no line for each step\n"
       "  --force              run what seems not to fit into memory or onto the disk; without it, that ends with "
       "exit\n"
       "                       code 2 before anything is written\n\n"
       "Ctrl-C ends the run after the present step, a second one at once; mixbeam resume goes on.\n"},
      {"batch",
       "usage: mixbeam batch SCENE.xml [options]\n\n"
       "Solves the cases of the list \"Batch\" of a scene. Cases that are alike are solved side by side, as one large\n"
       "structure; each is checked by itself and solved alone\n"
       "where it fails. Writes, with one row for each case: its parameters, what is followed, iterations, residual,\n"
       "whether it converged, and why not,\n"
       "  DIR/NAME-batch.csv     as a table\n"
       "  DIR/NAME-batch.h5      as columns\n\n"
       "  -o, --output DIR     folder for results; default: results/NAME\n"
       "  --case NAME          the load case, where the scene has some\n"
       "  --rows A:B           only cases A to B, into NAME-batch-A-B.csv: for arrays of jobs\n"
       "  --threads N, --summary FILE.json, --quiet, --force    as for mixbeam run\n\n"
       "With a folder in place of SCENE.xml: all scenes in it, a row for each scene and load case.\n"
       "Under mpirun the ranks share the cases; the table is the same, bit for bit.\n"
       "With cases that did not converge the exit code is 3; the others are in the table.\n"},
      {"check",
       "usage: mixbeam check SCENE.xml [--case NAME] [-o DIR]\n\n"
       "Reads and validates a scene and prints its size (members, elements, unknowns), what a run will take of\n"
       "memory, disk and time, lengths, loads of each stage, supports, warnings. Exit code 2 where a run would not "
       "fit\n"
       "into memory. Solves nothing (but whether the load moves what \"Control\" drives).\n\n"
       "  --case NAME          only this load case\n"
       "  -o, --output DIR     writes the undeformed structure to DIR/NAME.h5, also of a scene that is refused, which "
       "is\n"
       "                       what mixbeam view SCENE.xml draws; without it nothing is written\n\n"},
      {"parameters",
       "usage: mixbeam parameters [--markdown | --json]\n\n"
       "Lists every parameter that a scene file may hold, from the declarations that files are checked against.\n\n"
       "  --markdown           as a page of documentation\n"
       "  --json               as data for programs\n\n"},
      {"schema",
       "usage: mixbeam schema [--json]\n\n"
       "Prints a schema, with which editors complete, explain and check scenes: RELAX NG for XML (xmllint, Emacs, VS\n"
       "Code's XML extension), or for YAML\n\n"
       "  --json               JSON Schema (VS Code's YAML extension: setting yaml.schemas)\n\n"},
      {"convert",
       "usage: mixbeam convert FROM TO [--force], or mixbeam convert FROM -o TO\n\n"
       "Writes the scene FROM as TO, each in XML or YAML by the ending of its name (.xml, .yaml, .yml). What was "
       "written\n"
       "is read again and compared. Comments survive the way from XML to YAML.\n\n"
       "usage: mixbeam convert FILE [FILE]... TO [--force]\n\n"
       "Writes a scene of a blade with its sections: files of VABS (NAME.K) or BECAS (NAME.out), one for each section\n"
       "from root to tip, arrays of ANBA4, a blade file of BeamDyn (as SONATA writes it), an st file of HAWC2, or a "
       "turbine\n"
       "of WindIO in YAML.\n\n"
       "  --force              replaces TO if it is there\n\n"},
      {"resume",
       "usage: mixbeam resume RESULTS.h5 [options]\n\n"
       "Continues after the last completed step in a result file, to the very bits of a run that was never stopped, "
       "on\n"
       "any number of threads. The scene is the one in the file. Appends to the file, and writes NAME.xdmf and\n"
       "NAME-monitor.csv beside it.\n\n"
       "  --from STEP          continues after this step; later ones are dropped. For files that are damaged after it\n"
       "  --threads N, --summary FILE.json, --durable, --quiet, --force    as for mixbeam run\n\n"},
      {"verify",
       "usage: mixbeam verify RESULTS.h5 [--from STEP]\n\n"
       "Reads a result file and compares its checksums. Names the bytes and objects that are damaged, and the last "
       "step\n"
       "up to which all is intact. mixbeam resume and plot do so before they read a file.\n\n"
       "  --from STEP          damage after this step does not count\n\n"},
      {"plot",
       "usage: mixbeam plot RESULTS.h5 [options], or mixbeam plot SCENE.yaml\n\n"
       "Draws pictures of a result file or of a batch; mixbeam plot RESULTS.h5 --help lists them and all options. Of a "
       "scene\n"
       "its shape, without solving it. Needs Python with matplotlib and h5py.\n\n"
       "  -o, --output DIR     folder for pictures; default: beside the results\n"
       "  --view VIEW          xy, xz, yz, iso or AZIMUTH/ELEVATION in degrees\n"
       "  --members PATTERN    these members only\n"
       "  --scale FACTOR       of displacements\n"
       "  --moments SIDE       on which bending moments stand: tension, compression or left\n"
       "  --along PATTERN      one diagram over members in a row\n"
       "  --curve Y X          one followed number over another: force:wall.x tip.z\n\n"},
      {"report",
       "usage: mixbeam report RESULTS.h5 [-o FILE.html or FOLDER] [--summary SUMMARY.json]\n\n"
       "Writes one HTML page about a run, to attach to a project: result, stability, critical points, quantities,\n"
       "reactions, stresses, structure, pictures, versions, the scene. Needs Python with matplotlib and h5py.\n\n"},
      {"view",
       "usage: mixbeam view RESULTS.h5 [-o FILE.html] [--case NAME] [--watch], or mixbeam view SCENE.yaml\n\n"
       "Writes one HTML file, by default beside the results, that any browser with WebGL 2 opens without network: the\n"
       "deformed structure with its sections, coloured by any recorded field, step by step, with load path, critical\n"
       "points, modes, supports and loads. A scene is drawn without being solved, also one that a run refuses.\n\n"
       "  -o, --output FILE    default: RESULTS-view.html\n"
       "  --case NAME          this load case only, of several in one page\n"
       "  --watch              writes the page anew whenever the file changes, until Ctrl-C\n\n"},
  };
  return all;
}

}  // namespace

std::string help_text(const std::string& command) {
  if (command.empty()) return std::string(kProgram) + kExitCodes;
  const auto text = texts().find(command);
  return text == texts().end() ? "" : std::string(text->second) + kExitCodes;
}

}  // namespace mixbeam
