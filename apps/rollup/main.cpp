// The paper's first example: a rod bent to a double circle by a moment at its tip.
#include "apps/rollup/rollup_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "rollup";
  definition.purpose = "a straight cantilever bent to a double circle by a moment at its tip; convergence and locking.";
  definition.study = mixbeam::rollup_spec();
  definition.run_study = mixbeam::run_rollup_study;
  return mixbeam::run_application(argc, argv, definition);
}
