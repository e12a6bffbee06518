// Helix experiment: a straight rod bent and twisted into an exact helix by a moment at its tip.
#include "apps/helix/helix_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "helix";
  definition.purpose = "straight rod that a moment at its tip winds to an exact helix (helix experiment).";
  definition.study = mixbeam::helix_study_spec();
  definition.run_study = mixbeam::run_helix_study;
  return mixbeam::run_application(argc, argv, definition);
}
