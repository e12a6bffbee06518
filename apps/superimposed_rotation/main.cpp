// Superimposed rotation of a deformed cantilever: strains and energy of a bent rod must not notice ten turns of its
// clamp.
#include "apps/superimposed_rotation/rotation_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "superimposed_rotation";
  definition.purpose = "cantilever bent by a moment, then turned with its clamp (objectivity).";
  definition.study = mixbeam::rotation_study_spec();
  definition.own_quantities = {mixbeam::kMomentEnergy};
  definition.single = mixbeam::run_rotation;
  definition.run_study = mixbeam::run_rotation_study;
  return mixbeam::run_application(argc, argv, definition);
}
