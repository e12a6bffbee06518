// Three rods joined at right angles: table, load-displacement curve and shapes of the paper's example.
#include "apps/slope_discontinuity/slope_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "slope_discontinuity";
  definition.purpose = "three straight rods joined at right angles, clamped, under a force at the free end.";
  definition.study = mixbeam::slope_study_spec();
  definition.run_study = mixbeam::run_slope_study;
  return mixbeam::run_application(argc, argv, definition);
}
