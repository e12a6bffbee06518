// Fork under a force couple: table, representations of its semicircle, and independence of the order of loading.
#include "apps/fork/fork_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "fork";
  definition.purpose = "a shaft that branches into a semicircle, whose tips are pulled apart one after the other.";
  definition.study = mixbeam::fork_study_spec();
  definition.run_study = mixbeam::run_fork_study;
  return mixbeam::run_application(argc, argv, definition);
}
