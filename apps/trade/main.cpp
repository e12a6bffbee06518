// The trade between accuracy and cost: every order and mesh on many benchmarks, and which is the cheapest for a digit.
#include "apps/trade/trade_study.hpp"

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "trade";
  definition.purpose = "what each digit costs: error against time for every element order and mesh, on many scenes.";
  definition.study = mixbeam::trade_spec();
  definition.run_study = mixbeam::run_trade_study;
  return mixbeam::run_application(argc, argv, definition);
}
