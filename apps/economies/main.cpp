// What the features that a scene does not use would cost, and what cheaper arithmetic saves.
#include "apps/economies/economies_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "economies";
  definition.purpose =
      "one long rod solved as it is, with the general way forced on it, and with cheaper arithmetic: times and "
      "results.";
  definition.study = mixbeam::economies_spec();
  definition.run_study = mixbeam::run_economies_study;
  return mixbeam::run_application(argc, argv, definition);
}
