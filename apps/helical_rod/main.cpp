// Rod bent to helical shape: ten turns under a moment and a force that keep their directions in space.
#include "apps/helical_rod/helical_rod_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "helical_rod";
  definition.purpose =
      "straight rod that a dead moment and a dead force at its tip wind to ten turns (rod bent to helical shape).";
  definition.study = mixbeam::helical_rod_study_spec();
  definition.run_study = mixbeam::run_helical_rod_study;
  return mixbeam::run_application(argc, argv, definition);
}
