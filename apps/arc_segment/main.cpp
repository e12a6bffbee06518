// The paper's third example: a circular arc under a force out of its plane.
#include "apps/arc_segment/arc_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "arc_segment";
  definition.purpose =
      "45 degree arc clamped at one end under a force out of its plane; the paper's table, convergence.";
  definition.study = mixbeam::arc_spec();
  definition.run_study = mixbeam::run_arc_study;
  return mixbeam::run_application(argc, argv, definition);
}
