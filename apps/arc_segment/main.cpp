#include "apps/common/application.hpp"
int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "arc_segment";
  definition.purpose = "45 degree arc clamped at one end under a force out of its plane.";
  return mixbeam::run_application(argc, argv, definition);
}
