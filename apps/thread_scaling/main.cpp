// Median time of one Newton iteration, phase by phase, against the number of threads.
#include "apps/thread_scaling/scaling_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "thread_scaling";
  definition.purpose = "time of one Newton iteration on a chain of elements, split into phases, for 1, 2, .. threads.";
  definition.study = mixbeam::scaling_spec();
  definition.run_study = mixbeam::run_scaling_study;
  return mixbeam::run_application(argc, argv, definition);
}
