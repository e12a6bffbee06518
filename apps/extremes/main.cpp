// One quantity of a cantilever at a time to its limits: what converges, how fast, how exact, and where it ends.
#include "apps/extremes/extremes_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "extremes";
  definition.purpose =
      "a straight cantilever, one of its quantities at a time swept to its limits and held against a closed form.";
  definition.study = mixbeam::extremes_spec();
  definition.run_study = mixbeam::run_extremes_study;
  return mixbeam::run_application(argc, argv, definition);
}
